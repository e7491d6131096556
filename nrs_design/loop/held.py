"""What a drive does over a period, at the corners of what encloses it."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

from nrs_design.loop.constant_parameters import ConstantParameter
from nrs_design.loop.held_motor import WAY, Commands, HeldMotor
from nrs_design.loop.parameter_box import Box
from nrs_design.loop.sampled import DELTA, Rows
from nrs_design.models.linear_form import coordinates


class Label(NamedTuple):
    """At which end of a range a mode is, as its name says."""

    text: str
    attained: bool  # Whether a loop of the spec is at that end, rather than near it
    constant: bool  # Whether the number does not change


@dataclass(frozen=True, slots=True)
class Spot:
    """Where in its ranges something is."""

    labels: tuple[Label, ...] = ()
    # At which end each constant number is, low before high, by the names of the numbers.
    corner: tuple[tuple[str, int], ...] = ()

    def __add__(self, other: Spot) -> Spot:
        """Return where two things are that have no range in common."""
        return Spot(self.labels + other.labels, self.corner + other.corner)


@dataclass(frozen=True, slots=True, eq=False)
class HeldPoint:
    """One corner of what a drive does over a period."""

    spot: Spot
    rows: Rows


def points_of(
    motor: HeldMotor, changes: int, load: Box, constants: Iterable[ConstantParameter]
) -> tuple[HeldPoint, ...]:
    """Return the corners of a drive, beside those of the load that it moves.

    `changes` is how often commands change within a period.
    """
    box, constants = load.beside(motor.box), tuple(constants)
    return tuple(
        HeldPoint(spot, flow_rows(motor, changes, values))
        for spot, values in spots_of(box, motor.attained, constants)
    )


def flow_rows(motor: HeldMotor, changes: int, values: Mapping[str, Fraction]) -> Rows:
    """Return what a drive does at values of its numbers."""
    states = motor.states
    own = coordinates(len(states) + 2 + changes)
    place, first, *later = own[len(states) :]
    given = Commands(tuple(own[: len(states)]), place, first, tuple(later))
    found = {name: tuple(motor.result(name, given, values)) for name in (*states, WAY)}
    return {DELTA: found.pop(WAY), **found}


def spots_of(
    box: Box, attained: Collection[str], constants: Collection[ConstantParameter]
) -> Iterator[tuple[Spot, dict[str, Fraction]]]:
    """Yield the corners of a box with their values; `attained` are symbols with real ends."""
    for name, values in box.named_values(""):
        texts = name.split("/")[1:]
        yield spot_of(texts, attained, constants), values


def spot_of(
    texts: Collection[str], attained: Collection[str], constants: Iterable[ConstantParameter]
) -> Spot:
    """Return where labels say that something is."""
    corner, fixed = [], set()
    for constant in constants:
        for end, text in enumerate(constant.labels):
            if {*text.split("/")} <= {*texts}:
                corner.append((constant.said.name, end))
                fixed |= {*text.split("/")}
    labels = (Label(t, t.rpartition("-")[0] in attained, t in fixed) for t in texts)
    return Spot(tuple(labels), tuple(corner))
