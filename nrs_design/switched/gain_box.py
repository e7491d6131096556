"""Where the gains of a controller may be while the robot runs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction

from nrs_design.axis import AxisType
from nrs_design.controllers.controller_design import ControllerDesign
from nrs_design.controllers.float32 import exact_decimal
from nrs_design.controllers.gain_range import gain_interval
from nrs_design.controllers.laws import CompliantLaw, DiscreteLaw
from nrs_design.errors import AssemblyError, DesignError
from nrs_design.models.interval import Interval
from nrs_design.proof.bounds import rounded_down, rounded_up
from nrs_design.proof.text import exact_text
from nrs_design.spec import GainSpec
from nrs_design.switched.assumption import Assumption, say
from nrs_design.switched.parameter_box import Box


@dataclass(frozen=True, slots=True)
class GainBox:
    """The gains of one controller."""

    law: CompliantLaw  # With the gains that ship
    ranges: Mapping[str, Interval]  # Of every gain, around what ships

    @classmethod
    def point(cls, law: CompliantLaw) -> GainBox:
        """Return the box that holds the gains of one law."""
        return cls(law, {gain: Interval.point(value) for gain, value in law.gains.items()})

    @property
    def fixed(self) -> bool:
        """Whether the box is a point."""
        return all(interval.low == interval.high for interval in self.ranges.values())

    @property
    def box(self) -> Box:
        """The box in which the loop is affine in each gain, or in one over it."""
        return Box(self.ranges, self.law.inverse)

    def scaled(self, scale: Fraction, name: str) -> GainBox:
        """Return the box stretched about its nominal values.

        Parameters
        ----------
        scale : Fraction
            Not negative.
        name : str
            Of the controller, for errors.

        Raises
        ------
        AssemblyError
            If a gain with a range would not stay positive.
        """
        ranges = {gain: interval.scaled(scale) for gain, interval in self.ranges.items()}
        for gain, interval in ranges.items():
            if interval.low <= 0 and interval.low != interval.high:
                raise AssemblyError(
                    f"with its ranges scaled by {float(scale):.6g}, gain {gain} of controller "
                    f"{name} does not stay positive",
                    remedy="scale the ranges by less",
                )
        return GainBox(self.law, ranges)

    def range_texts(self, name: str, axis: AxisType) -> tuple[Assumption, ...]:
        """Say where the gains of a controller of that name may be, if they have ranges."""
        return tuple(
            say(
                "range.gain",
                gain=gain,
                name=name,
                ends=f"[{_text(interval.low)}, {_text(interval.high)}] "
                f"{axis.unit(self.law.units[gain])}",
            )
            for gain, interval in self.ranges.items()
            if interval.low != interval.high
        )


def _text(end: Fraction) -> str:
    """Write an end as a decimal: a single-precision number has many digits, but finitely many."""
    try:
        return exact_decimal(end)
    except ValueError:
        return exact_text(end)


def gain_boxes(
    declared: Mapping[str, Mapping[str, GainSpec]], design: ControllerDesign, scale: Fraction
) -> Mapping[str, GainBox]:
    """Return the box of every controller, by name.

    Parameters
    ----------
    declared : mapping
        The gains of each controller, with their ranges.
    design : ControllerDesign
        The nominal gains, inside their ranges.
    scale : Fraction
        Every range is stretched by it about the nominal gain.

    Raises
    ------
    AssemblyError
        If a gain would not stay positive.
    """
    boxes = {}
    for controller in design.controllers:
        law = controller.law
        gains = declared[controller.name].items()
        ranges = {name: gain_interval(gain, law.gains[name]) for name, gain in gains}
        box = GainBox(law, {**GainBox.point(law).ranges, **ranges})
        boxes[controller.name] = box.scaled(scale, controller.name)
    return boxes


@dataclass(frozen=True, slots=True)
class RangedLaw:
    """A law, and the box of what its coefficients are made of.

    Where Mt or Bt has a range, that is a and ``c = b/(1 - a)``, which is 1/Bt but for rounding;
    without inertia it is ``c = b`` alone. The map of a period is affine in each of them.
    """

    law: DiscreteLaw  # With the coefficients that ship
    box: Box  # Of ``a`` and ``c``, and of ``Kt``, as far as they have ranges

    @classmethod
    def of(cls, law: DiscreteLaw, gains: GainBox, period: Fraction, method: str) -> RangedLaw:
        """Enclose the coefficients of all gains in a box.

        Parameters
        ----------
        law : DiscreteLaw
            With the coefficients that ship.
        gains : GainBox
            Where the gains may be.
        period : Fraction
            In s.
        method : {"exact", "euler"}
            By which the law is discretized.

        Raises
        ------
        AssemblyError
            If single precision loses a coefficient.
        """
        if gains.fixed:
            return cls(law, Box({}))
        try:
            ranges = gains.law.enclose(gains.ranges, period, method)
        except DesignError as error:
            # At another scale of the ranges there may be a loop.
            raise AssemblyError(error.message, remedy=error.remedy, at=error.at) from error
        return cls(law, Box({symbol: r for symbol, r in ranges.items() if r.low != r.high}))

    def at(self, values: Mapping[str, Fraction]) -> DiscreteLaw:
        """Return the law at values of the box; other names are left alone."""
        ranged = {name: values[name] for name in self.box.ranges}
        return self.law.at(ranged) if ranged else self.law

    def texts(self, name: str) -> Iterator[Assumption]:
        """Say where the coefficients of a controller of that name may be."""
        said = {"a": "a", "c": "b/(1 - a)" if "a" in self.box.ranges else "b", "Kt": "Kt"}
        for symbol, interval in self.box.ranges.items():
            ends = f"[{rounded_down(interval.low)}, {rounded_up(interval.high)}]"
            yield say("range.sampled-gain", gain=said[symbol], name=name, ends=ends)
