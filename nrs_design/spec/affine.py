"""Affine functions of named parameters, exact: ``constant + sum of slope * parameter``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction


@dataclass(frozen=True, slots=True)
class Affine:
    """An affine function of parameters; two are equal iff they are the same function."""

    constant: Fraction  # Value where all parameters are zero
    # Parameter names with their factors, sorted by name, none of them zero.
    slopes: tuple[tuple[str, Fraction], ...] = ()

    @classmethod
    def of_parameter(cls, name: str) -> Affine:
        """Return the function that is one parameter."""
        return cls(Fraction(0), ((name, Fraction(1)),))

    @property
    def names(self) -> tuple[str, ...]:
        """The parameters that it depends on."""
        return tuple(name for name, _ in self.slopes)

    @property
    def numbers(self) -> tuple[Fraction, ...]:
        """The constant and the factors."""
        return (self.constant, *(slope for _, slope in self.slopes))

    @property
    def is_constant(self) -> bool:
        """Whether it depends on no parameter."""
        return not self.slopes

    def plus(self, other: Affine) -> Affine:
        """Add another function."""
        slopes = dict(self.slopes)
        for name, slope in other.slopes:
            slopes[name] = slopes.get(name, Fraction(0)) + slope
        kept = tuple(sorted((name, slope) for name, slope in slopes.items() if slope))
        return Affine(self.constant + other.constant, kept)

    def times(self, factor: Fraction) -> Affine:
        """Multiply by a number."""
        if not factor:
            return Affine(Fraction(0))
        slopes = tuple((name, slope * factor) for name, slope in self.slopes)
        return Affine(self.constant * factor, slopes)

    def at(self, values: Mapping[str, Fraction]) -> Fraction:
        """Evaluate at the given parameter values; a KeyError if one is missing."""
        return self.constant + sum(
            (slope * values[name] for name, slope in self.slopes), Fraction(0)
        )
