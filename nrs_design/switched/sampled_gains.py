"""Where the coefficients of a sampled law lie while its gains are anywhere in their ranges."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction

from nrs_design.controllers.laws import DiscreteLaw
from nrs_design.errors import AssemblyError, DesignError
from nrs_design.proof.bounds import rounded_down, rounded_up
from nrs_design.switched.assumption import Assumption, say
from nrs_design.switched.gain_box import GainBox
from nrs_design.switched.parameter_box import Box


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
