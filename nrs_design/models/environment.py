"""What the endoscope touches: tissue, tool or hand, with the range of its parameters."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from nrs_design.errors import AssemblyError


@dataclass(frozen=True, slots=True)
class Interval:
    """A nominal value and the closed range that it may move in, all exact."""

    nominal: Fraction
    low: Fraction
    high: Fraction

    @classmethod
    def point(cls, value: Fraction) -> Interval:
        """Return the interval that holds one value."""
        return cls(value, value, value)

    @property
    def ends(self) -> tuple[tuple[str, Fraction], ...]:
        """The labelled ends; a point has one end without a label."""
        if self.low == self.high:
            return (("", self.low),)
        return (("min", self.low), ("max", self.high))

    @property
    def middle(self) -> Fraction:
        """The value halfway between the ends."""
        return (self.low + self.high) / 2

    def scaled(self, scale: Fraction) -> Interval:
        """Return the interval stretched about its nominal value; with 0, that value only."""
        ends = (self.nominal + scale * (end - self.nominal) for end in (self.low, self.high))
        return Interval(self.nominal, *ends)


@dataclass(frozen=True, slots=True)
class Contact:
    """One environment with fixed parameters: reaction ``F = stiffness delta + damping delta'``.

    Parameters
    ----------
    label : str
        Such as ``soft`` or ``soft/k-min``.
    stiffness : Fraction
        In N m/rad.
    damping : Fraction
        In N m s/rad.
    """

    label: str
    stiffness: Fraction
    damping: Fraction


@dataclass(frozen=True, slots=True)
class Environment:
    """An elastic (damping zero) or Kelvin-Voigt environment, seen as a rotation (thesis 2.5).

    Parameters
    ----------
    name : str
        As in the spec.
    stiffness : Interval
        In N m/rad, positive.
    damping : Interval
        In N m s/rad, not negative.
    """

    name: str
    stiffness: Interval
    damping: Interval

    @property
    def nominal(self) -> Contact:
        """The environment at its nominal parameters."""
        return Contact(self.name, self.stiffness.nominal, self.damping.nominal)

    def scaled(self, scale: Fraction) -> Environment:
        """Return the environment with its ranges stretched about the nominal values.

        Raises
        ------
        AssemblyError
            If the stiffness would not stay positive, or the damping would become negative.
        """
        stiffness, damping = self.stiffness.scaled(scale), self.damping.scaled(scale)
        if stiffness.low <= 0 or damping.low < 0:
            quantity = "stiffness" if stiffness.low <= 0 else "damping"
            raise AssemblyError(
                f"with its ranges scaled by {float(scale):.6g}, environment {self.name} reaches a "
                f"{quantity} that no elastic or damped material has",
                remedy="scale the ranges by less",
            )
        return Environment(self.name, stiffness, damping)
