"""Where the gains of an impedance controller may be while the robot runs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from nrs_design.controllers.controller_design import ControllerDesign
from nrs_design.controllers.float32 import exact_decimal
from nrs_design.controllers.gain_range import gain_interval
from nrs_design.controllers.laws import Admittance
from nrs_design.errors import AssemblyError
from nrs_design.models.interval import Interval
from nrs_design.proof.text import exact_text
from nrs_design.spec import ImpedanceControllerSpec, InteractionDesignSpec
from nrs_design.switched.parameter_box import Axis


@dataclass(frozen=True, slots=True)
class GainBox:
    """Virtual inertia and damping of one controller.

    Parameters
    ----------
    Mt : Interval
        In kg m^2; positive, or the point zero.
    Bt : Interval
        In N m s/rad; positive.
    """

    Mt: Interval
    Bt: Interval

    @classmethod
    def point(cls, law: Admittance) -> GainBox:
        """Return the box that holds the gains of one law."""
        return cls(Interval.point(law.Mt), Interval.point(law.Bt))

    @property
    def fixed(self) -> bool:
        """Whether the box is a point."""
        return self.Mt.low == self.Mt.high and self.Bt.low == self.Bt.high

    @property
    def axes(self) -> tuple[Axis, Axis]:
        """The two axes: with inertia A is affine in 1/Mt and Bt, without it in 1/Bt."""
        massless = self.Mt.high == 0
        return Axis("Mt", self.Mt, inverse=not massless), Axis("Bt", self.Bt, inverse=massless)

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
        box = GainBox(self.Mt.scaled(scale), self.Bt.scaled(scale))
        for gain, interval in (("Mt", box.Mt), ("Bt", box.Bt)):
            if interval.low <= 0 and interval.low != interval.high:
                raise AssemblyError(
                    f"with its ranges scaled by {float(scale):.6g}, gain {gain} of controller "
                    f"{name} does not stay positive",
                    remedy="scale the ranges by less",
                )
        return box

    def range_texts(self, name: str) -> tuple[str, ...]:
        """Say where the gains of a controller of that name may be, if they have ranges."""
        return tuple(
            f"{gain} of {name} stays in [{_text(interval.low)}, {_text(interval.high)}] "
            f"{Admittance.units[gain]} and may change arbitrarily fast."
            for gain, interval in (("Mt", self.Mt), ("Bt", self.Bt))
            if interval.low != interval.high
        )

    @property
    def memory_text(self) -> str:
        """Say what the controller keeps while its gains change."""
        return STATIC_LAW if self.Mt.high == 0 else KEPT_VELOCITY


def _text(end: Fraction) -> str:
    """Write an end as a decimal: a single-precision number has many digits, but finitely many."""
    try:
        return exact_decimal(end)
    except ValueError:
        return exact_text(end)


KEPT_VELOCITY = (
    "While a gain changes, the admittance keeps its velocity vm: the controller integrates "
    "vm' = (F - Bt vm)/Mt with the gains of the moment. One that keeps Mt vm, or another memory of "
    "a filter, is not covered."
)
STATIC_LAW = (
    "With Mt = 0 the admittance has no memory: its velocity is F/Bt with the Bt of the moment, and "
    "jumps with it."
)


def gain_boxes(
    spec: InteractionDesignSpec, design: ControllerDesign, scale: Fraction
) -> Mapping[str, GainBox]:
    """Return the box of every impedance controller, by name.

    Parameters
    ----------
    spec : InteractionDesignSpec
        With the ranges.
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
        given, law = spec.controllers[controller.name], controller.law
        if isinstance(given, ImpedanceControllerSpec) and isinstance(law, Admittance):
            declared = GainBox(gain_interval(given.Mt, law.Mt), gain_interval(given.Bt, law.Bt))
            boxes[controller.name] = declared.scaled(scale, controller.name)
    return boxes
