"""Where the gains of a controller may be while the robot runs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from nrs_design.controllers.laws import CompliantLaw, DiscreteLaw
from nrs_design.models.interval import Interval
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


@dataclass(frozen=True, slots=True)
class RangedLaw:
    """A law, and the box of what its coefficients are made of.

    Where Mt or Bt has a range, that is a and ``c = b/(1 - a)``, which is 1/Bt but for rounding;
    without inertia it is ``c = b`` alone. The map of a period is affine in each of them.
    """

    law: DiscreteLaw  # With the coefficients that ship
    box: Box  # Of ``a`` and ``c``, and of ``Kt``, as far as they have ranges

    def at(self, values: Mapping[str, Fraction]) -> DiscreteLaw:
        """Return the law at values of the box; other names are left alone."""
        ranged = {name: values[name] for name in self.box.ranges}
        return self.law.at(ranged) if ranged else self.law
