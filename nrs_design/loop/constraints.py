"""From the switching rules of a spec to those of the assembled modes.

In a sampled loop stays are counted: a clock says which controller may be in force at a sample.
"""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import chain, islice, permutations, product
from math import ceil
from typing import TYPE_CHECKING, TypeVar

from nrs_design.errors import AssemblyError
from nrs_design.models.linear_form import coordinates, zero
from nrs_design.proof.assumption import Assumption
from nrs_design.proof.evidence.fields import MAX_STATES
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.switching import NOWHERE, Clock, Reset, Stay, Switching
from nrs_design.proof.text import exact_text
from nrs_design.spec import SwitchingSpec
from nrs_design.spec.misses import MissAutomaton
from nrs_design.spec.switching import ANY_SIGNAL, DwellTime

if TYPE_CHECKING:
    from nrs_design.controllers.controller_design import Controller

MAX_ASSEMBLED = 200_000

Groups = Mapping[str, Sequence[str]]
Transition = tuple[str, str]
Jump = tuple[str, str, RationalMatrix]
T = TypeVar("T")


def assemble_switching(
    rules: SwitchingSpec, groups: Groups, resets: Iterable[Jump] = ()
) -> Switching:
    """Carry the rules of a spec over to the assembled modes, which are grouped by its names.

    Corners and contacts of one name follow each other freely: parameters and environment move at
    will. Switches between names are allowed, and reset, for all their corners.
    """
    common = rules.dwell_time.value if isinstance(rules.dwell_time, DwellTime) else Fraction(0)
    transitions = None
    if rules.transitions is not None:
        self_pairs = ((name, name) for name in groups)
        transitions = _check_count(_expand(chain(self_pairs, rules.transitions), groups))
    jumps = _check_count(
        Reset(*pair, matrix)
        for source, target, matrix in resets
        for pair in _expand([(source, target)], groups)
    )
    dwells = tuple(_assembled_stays(rules, groups, Stay(common)))
    return Switching(common, transitions, jumps, stays=dwells)


def zeroing(states: Sequence[str], zeroed: Container[str]) -> RationalMatrix:
    """Return the map that sets some states to zero, and leaves the others."""
    rows = zip(states, coordinates(len(states)), strict=True)
    return RationalMatrix.from_rows([zero(len(states)) if s in zeroed else row for s, row in rows])


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


def _expand(pairs: Iterable[Transition], groups: Groups) -> Iterator[Transition]:
    for source, target in pairs:
        for a, b in product(groups[source], groups[target]):
            if a != b:
                yield a, b


def _check_count(switches: Iterator[T]) -> tuple[T, ...]:
    result = tuple(islice(switches, MAX_ASSEMBLED + 1))
    if len(result) > MAX_ASSEMBLED:
        raise AssemblyError(
            f"the rules make more than {MAX_ASSEMBLED} switches between corners",
            remedy="declare fewer transitions, resets, parameters or ranges",
            at=("switching",),
        )
    return result


def clock_of(automaton: MissAutomaton, in_time: tuple[str, ...]) -> Clock:
    """Return which modes may be in force at a step, by the automaton of a rule for misses."""
    pairs = zip(automaton.hit, automaton.miss, strict=True)
    ahead = ((hit, NOWHERE if miss is None else miss) for hit, miss in pairs)
    return Clock(automaton.count, in_time, tuple(ahead))


def count_stays(
    rules: SwitchingSpec, modes: Groups, period: Fraction
) -> tuple[Clock | None, SwitchingSpec, tuple[Assumption, ...]]:
    """Count stays in samples: return the clock, the remaining rules, and the assumptions.

    There is no clock where dwell times forbid nothing. `modes` are those of each controller, in
    contact and free; the period is the longest one, in s. A state of the clock is the number of
    samples that a controller has been in force, up to its dwell time.
    """
    names, shortest = [*modes], [rules.stay(name)[0] for name in modes]
    counts = [1 if stay is None else max(ceil(stay.value / period), 1) for stay in shortest]
    if len(names) < 2 or max(counts) == 1:
        no_dwell = {"dwell_time": None, "longest_dwell_time": None}
        return None, rules.model_copy(update=no_dwell), ()
    if sum(counts) > MAX_STATES:
        limit = MAX_STATES // len(names)
        raise AssemblyError(
            f"the dwell times are {sum(counts)} samples long, at most {MAX_STATES} are counted",
            remedy=f"write dwell times of up to {limit} samples each, which is "
            f"{exact_text(limit * period)} s: a longer stay keeps them",
            at=("switching", "dwell_time"),
        )
    first = [sum(counts[:k]) for k in range(len(counts))]
    transitions = None if rules.transitions is None else frozenset(rules.transitions)

    def leads(k: int, spent: int) -> tuple[int, ...]:
        """Return the next state for each controller, after `spent` samples of the k-th one."""
        last = counts[k] - 1
        targets = [NOWHERE] * len(names)
        if spent == last:
            for other, name in enumerate(names):
                if transitions is None or (names[k], name) in transitions:
                    targets[other] = first[other]
        targets[k] = first[k] + min(spent + 1, last)
        return tuple(targets)

    ahead = tuple(leads(k, spent) for k, count in enumerate(counts) for spent in range(count))
    primary, *others = (tuple(found) for found in modes.values())
    clock = Clock(len(ahead), primary, ahead, tuple(others[:-1]))
    texts = tuple(f"{name} {count}" for name, count in zip(names, counts, strict=True))
    return clock, ANY_SIGNAL, (Assumption.create("rules.counted", counts=texts),)
