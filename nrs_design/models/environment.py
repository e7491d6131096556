"""What the endoscope touches: tissue, tool or hand, with the range of its parameters."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from itertools import product


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

    def vertices(self) -> Iterator[Contact]:
        """Yield the corners of the parameter box."""
        for (k_end, k), (b_end, b) in product(self.stiffness.ends, self.damping.ends):
            ends = [f"{symbol}-{end}" for symbol, end in (("k", k_end), ("b", b_end)) if end]
            yield Contact("/".join([self.name, *ends]), k, b)
