"""Modes, their place in the ranges of a loop, and parameters that are unknown but constant."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import product
from math import prod
from typing import NamedTuple

from nrs_design.errors import AssemblyError, InternalError
from nrs_design.models.drive import GAIN
from nrs_design.models.interval import Interval
from nrs_design.models.linear_form import LinearForm
from nrs_design.models.plant import Plant
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode
from nrs_design.proof.switching import FixedParameter
from nrs_design.proof.system import SwitchedSystem

MAX_CORNERS = 50_000


@dataclass(frozen=True, slots=True)
class ConstantParameter:
    """One parameter that does not change while the robot runs."""

    fixed: FixedParameter  # Its name and range
    # Labels of the low and the high end in names of modes, such as ``k-min``.
    labels: tuple[str, str]
    contact: str | None = None  # Contact with this parameter; None if it occurs in all modes

    @property
    def symbol(self) -> str:
        """Symbol of the parameter in labels."""
        return self.labels[0].rpartition("-")[0]


class Label(NamedTuple):
    """End of a range, as the name of a mode says it."""

    text: str
    attained: bool  # True for an end of the spec, False for a point of an enclosure
    constant: bool  # Whether the number does not change


@dataclass(frozen=True, slots=True)
class Spot:
    """Place of a mode in its ranges."""

    labels: tuple[Label, ...] = ()
    # End of each constant number by name, 0 for low and 1 for high; or its point on a curve.
    corner: tuple[tuple[str, int], ...] = ()

    @classmethod
    def from_names(cls, *names: str) -> Spot:
        """Return a place with these names, whatever the ranges are."""
        return cls(tuple(Label(name, attained=True, constant=False) for name in names))

    def __add__(self, other: Spot) -> Spot:
        """Return where two things are that have no range in common."""
        return Spot(self.labels + other.labels, self.corner + other.corner)


def labelled_ends(
    ranges: Mapping[str, Interval],
) -> Iterator[tuple[tuple[str, ...], dict[str, Fraction]]]:
    """Yield the labels and the values at the ends of ranges, the last one turning fastest."""
    for ends in product(*(interval.ends for interval in ranges.values())):
        pairs = [(symbol, *end) for symbol, end in zip(ranges, ends, strict=True)]
        labels = tuple(f"{symbol}-{end}" for symbol, end, _ in pairs if end)
        yield labels, {symbol: value for symbol, _, value in pairs}


def spot_of(
    texts: Collection[str],
    attained: Collection[str],
    constants: Iterable[ConstantParameter],
    curve: tuple[str, int] | None = None,
) -> Spot:
    """Return the place that labels describe; `attained` are symbols with real ends.

    On the curve of a constant number, its corners are the points around the curve.
    """
    corner, fixed = [], set()
    for constant in constants:
        if curve is not None and curve[0] == constant.symbol:
            corner.append((constant.fixed.name, curve[1]))
            fixed.add(f"flow-{curve[1]}")
        for end, text in enumerate(constant.labels):
            if text in texts:
                corner.append((constant.fixed.name, end))
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
    medium: str
    period: Period
    starts_round: bool = False  # Whether a round begins with this mode

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


def constant_lateness(
    name: str, lateness: tuple[Fraction, Fraction], period: Fraction
) -> ConstantParameter:
    """Return the time from a sample to its command, in s, as a constant parameter.

    One command takes effect in each period, and a mode is at an end of the time that is then left.
    """
    symbol = f"h{lateness[0] // period}"
    fixed = FixedParameter(name, *lateness, "s", enclosed=True)
    return ConstantParameter(fixed, (f"{symbol}-max", f"{symbol}-min"))


def constants_of(
    plant: Plant, names: Collection[str], part: str, *, sampled: bool
) -> Iterator[ConstantParameter]:
    """Yield the constant parameters of a plant; `part` is the part of the spec that its drive is.

    The flow of a period encloses the numbers of its drive, but for the gain of a motor, and those
    of a load: their corners are none of their values.
    """
    drive = plant.zoh_drive
    contacts = [e for e in plant.environments if not e.parts and e.name in names]
    for symbol, interval in drive.ranges.items():
        if interval.is_constant:
            key, unit = _DRIVEN[symbol]
            fixed = FixedParameter(
                f"{part}.{key}",
                interval.low,
                interval.high,
                unit.format(command=plant.actuator_ranges.command),
                symbol in drive.inverse,
                enclosed=sampled and symbol != GAIN,
            )
            yield ConstantParameter(fixed, _ends(symbol))
    for e in contacts:
        keys = zip(e.law.keys, e.law.parameters(), e.law.units(rotational=True), strict=True)
        for (key, symbol, unit), interval in zip(keys, e.ranges, strict=True):
            if not interval.is_constant:
                continue
            enclosed = sampled and drive.loaded
            if enclosed and len(names) > 1:
                raise InternalError("the ends of constants of several contacts are not told apart")
            fixed = FixedParameter(
                f"environments.{e.name}.{key}",
                interval.low,
                interval.high,
                unit,
                symbol in e.law.inverse,
                enclosed,
            )
            yield ConstantParameter(fixed, _ends(symbol), e.name)


# Symbols of the parameters of a drive, with their keys in a spec and their units.
_DRIVEN = {
    "J": ("inertia", "kg*m^2"),
    "B": ("friction", "N*m*s/rad"),
    "tau": ("time_constant", "s"),
    GAIN: ("gain", "rad/s/{command}"),
}


def _ends(symbol: str) -> tuple[str, str]:
    return f"{symbol}-min", f"{symbol}-max"


def corner_counts(
    modes: Iterable[LocatedMode], parameters: Iterable[ConstantParameter]
) -> list[int]:
    """Return the number of corners of each constant parameter: two, or more around a curve."""
    ends = [dict(mode.spot.corner) for mode in modes]
    return [1 + max(1, *(corner.get(p.fixed.name, 0) for corner in ends)) for p in parameters]


def constant_sets(
    modes: Sequence[LocatedMode], parameters: Sequence[ConstantParameter]
) -> Iterator[tuple[str, ...]]:
    """Yield, for each mode, its copies at the corners of the constant parameters.

    A mode without a parameter is the same at both of its ends. The last one turns fastest.
    """
    if not parameters:
        return
    # By the varying parts of the name, and the corner of the constants.
    known: dict[tuple[tuple[str, ...], tuple[int | None, ...]], str] = {}
    first: dict[tuple[tuple[str, ...], tuple[bool, ...]], None] = {}
    for mode in modes:
        corner = dict(mode.spot.corner)
        ends = tuple(corner.get(parameter.fixed.name) for parameter in parameters)
        known[mode.varying, ends] = mode.name
        first[mode.varying, tuple(end is not None for end in ends)] = None
    counts = corner_counts(modes, parameters)
    for varying, has in first:
        corners = product(*map(range, counts))
        keys = [
            tuple(c if h else None for c, h in zip(place, has, strict=True)) for place in corners
        ]
        if any((varying, key) not in known for key in keys):
            raise InternalError(f"a corner of {varying[0]} has no mode")
        yield tuple(known[varying, key] for key in keys)


def add_constants(
    system: SwitchedSystem, parameters: Sequence[ConstantParameter], modes: Sequence[LocatedMode]
) -> SwitchedSystem:
    """Return the system, with a mode for each corner, with parameters that do not change."""
    if not parameters:
        return system
    count = prod(corner_counts(modes, parameters)) * len(system.modes)
    if count > MAX_CORNERS:
        raise AssemblyError(
            f"the modes at all corners of the constant parameters are up to {count}, at most "
            f"{MAX_CORNERS} are looked at",
            remedy="leave out `varies: false` for some of the ranges",
        )
    sets = tuple(constant_sets(modes, parameters))
    fixed = tuple(parameter.fixed for parameter in parameters)
    return replace(
        system, switching=replace(system.switching, fixed_ends=sets, fixed_parameters=fixed)
    )
