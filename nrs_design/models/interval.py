"""A nominal value and the range that it may move in."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeVar

from nrs_design.proof.text import exact_text

Number = TypeVar("Number", float, Fraction)


@dataclass(frozen=True, slots=True)
class Interval:
    """A nominal value and the closed range that it may move in, all exact."""

    nominal: Fraction
    low: Fraction
    high: Fraction
    varies: bool = True  # False for an unknown constant

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
        low, high = (self.nominal + scale * (end - self.nominal) for end in (self.low, self.high))
        return Interval(self.nominal, low, high, self.varies)

    @property
    def text(self) -> str:
        """The value of a point, or both ends in brackets, exactly."""
        if self.low == self.high:
            return exact_text(self.low)
        return f"[{exact_text(self.low)}, {exact_text(self.high)}]"

    @property
    def description(self) -> str:
        """Text behind the name of a number: ``= 2``, or ``in [1, 3]``."""
        return f"{'in' if self.ends[1:] else '='} {self.text}"

    @property
    def is_constant(self) -> bool:
        """Whether the value is an unknown constant of a range."""
        return not self.varies and self.low != self.high


def turn(value: Number, radius: Number) -> Number:
    """Convert a linear stiffness, damping or mass to the pivot: ``k r^2`` (thesis 6.3.1.1)."""
    return value * radius**2


def moving(numbers: Iterable[Interval]) -> str:
    """Return whether ``all`` numbers with a range may move there, or ``some``; empty if none."""
    ranges = [number for number in numbers if number.low != number.high]
    if not any(number.varies for number in ranges):
        return ""
    return "some" if any(n.is_constant for n in ranges) else "all"
