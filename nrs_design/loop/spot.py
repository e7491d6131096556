"""Where in its ranges a mode is."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from typing import NamedTuple

from nrs_design.loop.constant_parameters import ConstantParameter
from nrs_design.models.interval import Interval


class Label(NamedTuple):
    """At which end of a range a mode is, as its name says."""

    text: str
    attained: bool  # Whether a loop of the spec is at that end, rather than near it
    constant: bool  # Whether the number does not change


@dataclass(frozen=True, slots=True)
class Spot:
    """Where in its ranges something is."""

    labels: tuple[Label, ...] = ()
    # At which end each constant number is, low before high, by its name; or which curve point.
    corner: tuple[tuple[str, int], ...] = ()

    @classmethod
    def named(cls, *names: str) -> Spot:
        """Return where what has such names is, whatever its ranges are."""
        return cls(tuple(Label(name, attained=True, constant=False) for name in names))

    def __add__(self, other: Spot) -> Spot:
        """Return where two things are that have no range in common."""
        return Spot(self.labels + other.labels, self.corner + other.corner)


def labelled_ends(
    ranges: Mapping[str, Interval],
) -> Iterator[tuple[tuple[str, ...], dict[str, Fraction]]]:
    """Yield the labels and the values at the ends of ranges, the last one turning fastest."""
    for ends in product(*(interval.ends for interval in ranges.values())):
        named = [(symbol, *end) for symbol, end in zip(ranges, ends, strict=True)]
        labels = tuple(f"{symbol}-{end}" for symbol, end, _ in named if end)
        yield labels, {symbol: value for symbol, _, value in named}


def spot_of(
    texts: Collection[str],
    attained: Collection[str],
    constants: Iterable[ConstantParameter],
    curve: tuple[str, int] | None = None,
) -> Spot:
    """Return where labels say that something is; `attained` are symbols with real ends.

    On the curve of a constant number, its corners are the points around the curve.
    """
    corner, fixed = [], set()
    for constant in constants:
        if curve is not None and curve[0] == constant.symbol:
            corner.append((constant.said.name, curve[1]))
            fixed.add(f"flow-{curve[1]}")
        for end, text in enumerate(constant.labels):
            if text in texts:
                corner.append((constant.said.name, end))
                fixed.add(text)
    labels = (Label(t, t.rpartition("-")[0] in attained, t in fixed) for t in texts)
    return Spot(tuple(labels), tuple(corner))
