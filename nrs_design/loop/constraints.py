"""From the switching rules of a spec to those of the assembled modes."""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import chain, islice, permutations, product
from typing import TYPE_CHECKING, TypeVar

from nrs_design.errors import AssemblyError
from nrs_design.models.linear_form import coordinates, zero
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.switching import Reset, Stay, Switching
from nrs_design.spec import DwellTime, SwitchingSpec

if TYPE_CHECKING:
    from nrs_design.controllers.controller_design import Controller

MAX_ASSEMBLED = 200_000

Groups = Mapping[str, Sequence[str]]
Transition = tuple[str, str]
Jump = tuple[str, str, RationalMatrix]
T = TypeVar("T")


def assemble_switching(
    rules: SwitchingSpec,
    groups: Groups,
    resets: Iterable[Jump] = (),
) -> Switching:
    """Carry the rules of a spec over to the assembled modes, which are grouped by its names.

    Corners and contacts of one name follow each other freely, because parameters and environment
    move as they like. Switches between names are allowed, and reset, for all their corners. An
    `AssemblyError` if the rules become too many.
    """
    common = rules.dwell_time.value if isinstance(rules.dwell_time, DwellTime) else Fraction(0)
    transitions = None
    if rules.transitions is not None:
        within = ((name, name) for name in groups)
        transitions = _limited(_expand(chain(within, rules.transitions), groups))
    jumps = _limited(_assembled_resets(resets, groups))
    stays = tuple(_assembled_stays(rules, groups, Stay(common)))
    return Switching(common, transitions, jumps, stays=stays)


def zeroing(states: Sequence[str], zeroed: Container[str]) -> RationalMatrix:
    """Return the map that sets some states to zero, and leaves the others."""
    each = zip(states, coordinates(len(states)), strict=True)
    return RationalMatrix.from_rows([zero(len(states)) if s in zeroed else row for s, row in each])


def leaving_impedance(controllers: Sequence[Controller]) -> Iterator[Transition]:
    """Yield the switches from controllers that command a velocity to those of a position."""
    for source, target in permutations(controllers, 2):
        if (source.law.commands, target.law.commands) == ("velocity", "position"):
            yield source.name, target.name


def _assembled_stays(
    rules: SwitchingSpec, groups: Groups, common: Stay
) -> Iterator[tuple[str, Stay]]:
    """Yield how long the modes stay active that have dwell times of their own."""
    for name, modes in groups.items():
        shortest, longest = rules.stay(name)
        stay = Stay(
            Fraction(0) if shortest is None else shortest.value,
            None if longest is None else longest.value,
        )
        if stay != common:
            yield from ((mode, stay) for mode in modes)


def _assembled_resets(resets: Iterable[Jump], groups: Groups) -> Iterator[Reset]:
    for before, after, matrix in resets:
        for source, target in _expand([(before, after)], groups):
            yield Reset(source, target, matrix)


def _expand(pairs: Iterable[Transition], groups: Groups) -> Iterator[Transition]:
    for source, target in pairs:
        for a, b in product(groups[source], groups[target]):
            if a != b:
                yield a, b


def _limited(found: Iterator[T]) -> tuple[T, ...]:
    kept = tuple(islice(found, MAX_ASSEMBLED + 1))
    if len(kept) > MAX_ASSEMBLED:
        raise AssemblyError(
            f"the rules make more than {MAX_ASSEMBLED} switches between corners",
            remedy="declare fewer transitions, resets, parameters or ranges",
            at=("switching",),
        )
    return kept
