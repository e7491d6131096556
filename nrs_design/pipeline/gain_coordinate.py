"""One free gain: bounds, and text in a spec."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from math import exp, log
from typing import TYPE_CHECKING

from nrs_design.controllers.float32 import neighbors, round_significant
from nrs_design.proof.text import exact_text

if TYPE_CHECKING:
    from nrs_design.pipeline.design import Designed
    from nrs_design.spec import GainSpec, Quantity


CLOSE = 1e-6  # Largest distance of a logarithm from a bound that counts as the bound
BOUND_TOLERANCE = 1e-3  # The same after a search
BOUNDED = ("Mt", "Bt")  # The gains that are free by bounds of their own


@dataclass(frozen=True)
class GainCoordinate:
    """A gain that may be chosen, within positive bounds; a point holds its logarithm."""

    controller: str  # Or ``motion``
    gain: str
    unit: str
    low: Fraction  # SI units
    high: Fraction
    # Bounds as in the spec; None for factors on a given gain.
    written: tuple[Quantity, Quantity] | None = None
    given: Fraction | None = None  # The gain that the factors are on

    @property
    def ends(self) -> tuple[float, float]:
        """Lowest and highest logarithm."""
        return log(self.low), log(self.high)

    @property
    def name(self) -> tuple[str, str]:
        """Controller and gain."""
        return self.controller, self.gain

    def value(self, x: float) -> float:
        """Return the gain at a coordinate, within the bounds."""
        low, high = self.ends
        return exp(min(max(x, low), high))

    def settled(self, x: float) -> float:
        """Return the same, and a bound itself where a search stopped at it."""
        bounds = zip(self.ends, (self.low, self.high), strict=True)
        ends = (float(bound) for end, bound in bounds if abs(x - end) < CLOSE)
        return next(ends, self.value(x))

    def near(self, x: float, digits: int) -> list[tuple[Fraction, str]]:
        """Return values near a coordinate as a spec may give them, and their texts.

        Of a gain that a spec gives, and that is free by factors, that is the nearest one only.
        """
        for end in self.written or ():
            if end.exact > 0 and abs(x - log(end.si)) < CLOSE:
                return [(end.exact, end.text)]
        value = self.value(x)
        found = {round_significant(neighbor, digits) for neighbor in neighbors(value, digits)}
        candidates = sorted(v for v in found if self.low <= v <= self.high and v > 0)
        if self.written is None:
            # Between close bounds there may be no number of so few digits.
            at = min(candidates, key=lambda v: abs(v - Fraction(value)), default=self.given)
            assert at is not None, "as factors are on a given gain"
            candidates = [at]
        return [(v, f"{exact_text(v)} {self.unit}") for v in candidates]

    def at_bound(self, x: float) -> str | None:
        """Say on which of its bounds a gain is that is free by factors; None if on neither."""
        if self.given is None:
            return None
        bounds = zip(("lower", "upper"), self.ends, strict=True)
        return next((name for name, end in bounds if abs(x - end) < BOUND_TOLERANCE), None)


def bounded_gain(
    controller: str, gain: str, spec: GainSpec, low: Fraction, unit: str
) -> GainCoordinate | None:
    """Return the coordinate of a gain with bounds; None where they leave nothing to choose.

    The lower bound is in SI, above that of the spec where the spec allows zero.
    """
    if not 0 < low < spec.max.exact:
        return None
    return GainCoordinate(controller, gain, unit, low, spec.max.exact, (spec.min, spec.max))


def freed_gains(designed: Designed) -> Iterator[GainCoordinate]:
    """Yield the gains that ``design.free`` names, with bounds about what the spec gives."""
    laws, units = designed.design.laws, designed.design.units
    for name, free in designed.spec.design.free.items():
        for gain, factors in free.given():
            at = laws[name].gains[gain]
            low, high = factors.min * at, factors.max * at
            if low < high:
                yield GainCoordinate(name, gain, units[name][gain], low, high, given=at)


# Texts of chosen gains with units, by controller and name.
Written = Mapping[tuple[str, str], str]
