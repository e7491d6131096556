"""Search for a growing signal of whole rounds, or of missed deadlines (untrusted)."""

from __future__ import annotations

from fractions import Fraction
from itertools import product

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.evidence import GrowingSequence
from nrs_design.proof.evidence.growth import Steps
from nrs_design.proof.mode import Mode
from nrs_design.proof.switching import Clock
from nrs_design.search.balance import scale_states
from nrs_design.search.branches import best_words
from nrs_design.search.candidates import Candidates
from nrs_design.search.family import Family, stand_ins, to_floats
from nrs_design.search.period import NOTHING_GROWS, WORDS, powers
from nrs_design.search.step_graph import StepGraph
from nrs_design.search.words import growing_words

Array = NDArray[np.float64]

# So many rounds, those that grow the most alone, are put in a row.
LETTERS = 8


def search_rounds(family: Family) -> Candidates[GrowingSequence]:
    """Search among rounds of one mode for the first step and one for all others."""
    system, clock = family.system, family.system.clock
    if clock is None:
        return NOTHING_GROWS
    if not clock.is_round:
        graph = turns_graph(family, clock)
        for word, growth in best_words(graph, family.allowance.part(WORDS), 1.0):
            yield from powers(system, graph.sequence(word)[0], (), growth ** len(word))
        return NOTHING_GROWS
    first, others = (
        _distinct([mode for mode in system.modes if (mode.name in clock.first) == begins])
        for begins in (True, False)
    )
    rest = clock.length - 1
    rounds = [
        (float(np.abs(np.linalg.eigvals(whole)).max()), (a.name, b.name), whole)
        for (a, A), (b, B) in product(first, others)
        for whole in [np.linalg.matrix_power(B, rest) @ A]
    ]
    rounds.sort(key=lambda item: -item[0])
    for radius, names, _ in rounds[:1]:
        yield from powers(system, _signal([names], rest), (), radius)
    matrices = np.array([whole for _, _, whole in rounds[:LETTERS]])
    for word, radius in growing_words(matrices, family.allowance):
        yield from powers(system, _signal([rounds[i][1] for i in word], rest), (), radius)
    return NOTHING_GROWS


def turns_graph(family: Family, clock: Clock) -> StepGraph:
    """Return the steps that an automaton allows, of modes that differ by no more than rounding."""
    system, names = family.system, frozenset(clock.first)
    kinds = [
        _distinct([mode for mode in system.modes if (mode.name in names) is first])
        for first in (True, False)
    ]
    modes = [
        (mode.name, A, first)
        for first, kind in zip((True, False), kinds, strict=True)
        for mode, A in kind
    ]
    texts, matrices, first = zip(*modes, strict=True)
    scaled = scale_states(np.array(matrices), family.exponents)
    return StepGraph.of_clock(clock, texts, scaled, first)


def _signal(rounds: list[tuple[str, str]], rest: int) -> Steps:
    pairs = (((a, Fraction(1)), (b, Fraction(rest))) for a, b in rounds)
    return tuple(step for pair in pairs for step in pair)


def _distinct(modes: list[Mode]) -> list[tuple[Mode, Array]]:
    """Return modes in floating point, without those that differ by an enclosed number."""
    matrices = to_floats([mode.A for mode in modes])
    named = stand_ins([mode.name for mode in modes], matrices)
    pairs = zip(modes, matrices, strict=True)
    return [(mode, A) for mode, A in pairs if named[mode.name] == mode.name]
