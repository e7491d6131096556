"""Unknown but constant parameters, and the modes at their corners."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import product
from math import prod
from typing import TYPE_CHECKING

from nrs_design.errors import AssemblyError, InternalError
from nrs_design.loop.located import ConstantParameter, LocatedMode
from nrs_design.models.drive import GAIN
from nrs_design.proof.switching import FixedParameter
from nrs_design.proof.system import SwitchedSystem

if TYPE_CHECKING:
    from nrs_design.models.plant import Plant

MAX_CORNERS = 50_000


def constant_lateness(
    name: str, late: tuple[Fraction, Fraction], period: Fraction
) -> ConstantParameter:
    """Return the time from a sample to its command, in s, as a constant parameter.

    It is within one period, so one command takes effect in each, and a mode is at an end of what is
    left of the period then: the longer it is, the earlier the command.
    """
    symbol = f"h{late[0] // period}"
    said = FixedParameter(name, *late, "s", enclosed=True)
    return ConstantParameter(said, (f"{symbol}-max", f"{symbol}-min"))


def constants_of(
    plant: Plant, touched: Collection[str], part: str, *, sampled: bool
) -> Iterator[ConstantParameter]:
    """Yield the constant parameters of a plant; `part` is the part of the spec that its drive is.

    The flow of a period encloses the numbers of its drive, but for the gain of a motor, and those
    of a load: their corners are none of their values.
    """
    drive = plant.held
    contacts = [e for e in plant.environments if not e.parts and e.name in touched]
    for symbol, interval in drive.ranges.items():
        if interval.is_constant:
            key, unit = _DRIVEN[symbol]
            said = FixedParameter(
                f"{part}.{key}",
                interval.low,
                interval.high,
                unit.format(command=plant.actuator_ranges.command),
                symbol in drive.inverse,
                enclosed=sampled and symbol != GAIN,
            )
            yield ConstantParameter(said, _ends(symbol))
    for e in contacts:
        keys = zip(e.law.keys, e.law.parameters(), e.law.units(rotational=True), strict=True)
        for (key, symbol, unit), interval in zip(keys, e.ranges, strict=True):
            if not interval.is_constant:
                continue
            enclosed = sampled and drive.loaded
            if enclosed and len(touched) > 1:
                raise InternalError("the ends of constants of several contacts are not told apart")
            said = FixedParameter(
                f"environments.{e.name}.{key}",
                interval.low,
                interval.high,
                unit,
                symbol in e.law.inverse,
                enclosed,
            )
            yield ConstantParameter(said, _ends(symbol), e.name)


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
    return [1 + max(1, *(at.get(p.said.name, 0) for at in ends)) for p in parameters]


def constant_sets(
    modes: Sequence[LocatedMode], parameters: Sequence[ConstantParameter]
) -> Iterator[tuple[str, ...]]:
    """Yield, for each mode, its copies at the corners of the constant parameters.

    A mode that a parameter is not in is the same at both of its ends. The last parameter turns
    fastest.
    """
    if not parameters:
        return
    # By the varying parts of the name, and the corner of the constants.
    known: dict[tuple[tuple[str, ...], tuple[int | None, ...]], str] = {}
    first: dict[tuple[tuple[str, ...], tuple[bool, ...]], None] = {}
    for mode in modes:
        corner = dict(mode.spot.corner)
        ends = tuple(corner.get(parameter.said.name) for parameter in parameters)
        known[mode.varying, ends] = mode.name
        first[mode.varying, tuple(end is not None for end in ends)] = None
    counts = corner_counts(modes, parameters)
    for varying, has in first:
        every = product(*map(range, counts))
        keys = [tuple(c if h else None for c, h in zip(at, has, strict=True)) for at in every]
        if any((varying, key) not in known for key in keys):
            raise InternalError(f"a corner of {varying[0]} has no mode")
        yield tuple(known[varying, key] for key in keys)


def with_constants(
    system: SwitchedSystem, parameters: Sequence[ConstantParameter], modes: Sequence[LocatedMode]
) -> SwitchedSystem:
    """Return the system, with a mode for each corner, with parameters that do not change.

    An `AssemblyError` if they have too many corners.
    """
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
    said = tuple(parameter.said for parameter in parameters)
    return replace(
        system, switching=replace(system.switching, fixed_ends=sets, fixed_parameters=said)
    )
