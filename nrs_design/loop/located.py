"""Modes, and where in the ranges of a loop they stand."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from typing import NamedTuple

from nrs_design.models.interval import Interval
from nrs_design.models.linear_form import LinearForm
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode
from nrs_design.proof.switching import FixedParameter


@dataclass(frozen=True, slots=True)
class ConstantParameter:
    """One parameter that does not change while the robot runs."""

    said: FixedParameter  # Its name and range
    # Labels of the low and the high end in names of modes, such as ``k-min``.
    labels: tuple[str, str]
    contact: str | None = None  # Contact with this parameter; None if it occurs in all modes

    @property
    def symbol(self) -> str:
        """Symbol of the parameter in labels."""
        return self.labels[0].rpartition("-")[0]


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


@dataclass(frozen=True, slots=True)
class Period:
    """Map of one period, or rates in 1/s: linear forms over states, inputs and roundings."""

    moves: Sequence[LinearForm]  # The states after it
    sizes: Sequence[LinearForm] = ()  # Bound on each rounding
    command: LinearForm = ()  # Before it is cut off


@dataclass(frozen=True, slots=True, eq=False)
class LocatedMode:
    """A mode and its corner of the ranges."""

    group: str  # The name that rules of switching know: a controller, or what is done instead
    spot: Spot
    # Environment of the force (sample), or free motion; empty if it is the same in all contacts
    touches: str
    period: Period
    begins: bool = False  # Whether a round begins with this mode

    @property
    def name(self) -> str:
        """Its name in certificates."""
        return "/".join(label.text for label in self.spot.labels)

    @property
    def mode(self) -> Mode:
        """The mode, as a proof is about it."""
        moves = self.period.moves
        rows = [row[: len(moves)] for row in moves]
        return Mode(self.name, RationalMatrix.from_rows(rows))

    @property
    def varying(self) -> tuple[str, ...]:
        """Parts of its name without the ends of constant parameters."""
        return tuple(label.text for label in self.spot.labels if not label.constant)

    def column(self, i: int) -> RationalMatrix:
        """Return the column of the i-th input, or rounding after the inputs."""
        moves = self.period.moves
        return RationalMatrix.from_rows([[row[len(moves) + i]] for row in moves])


def grouped(items: Iterable[LocatedMode]) -> dict[str, list[str]]:
    """Return the names of modes by their groups."""
    groups: dict[str, list[str]] = {}
    for item in items:
        groups.setdefault(item.group, []).append(item.name)
    return groups


def enclosures_of(items: Iterable[LocatedMode]) -> Iterator[tuple[str, ...]]:
    """Yield the modes that enclose one map or motion together."""
    found: dict[tuple[str, ...], list[str]] = {}
    for item in items:
        attained = tuple(label.text for label in item.spot.labels if label.attained)
        found.setdefault(attained, []).append(item.name)
    yield from (tuple(names) for names in found.values() if len(names) > 1)
