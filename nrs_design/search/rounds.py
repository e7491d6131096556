"""Search for a growing signal of whole rounds, or of missed deadlines (untrusted)."""

from __future__ import annotations

from fractions import Fraction
from itertools import groupby, product

import numpy as np

from nrs_design.proof.clock import on_turn
from nrs_design.proof.evidence import GrowingSequence
from nrs_design.proof.evidence.growth import Steps
from nrs_design.proof.switching import Clock
from nrs_design.search.balance import scale_states
from nrs_design.search.branches import best_words
from nrs_design.search.candidates import Candidates
from nrs_design.search.family import Family, distinct_modes
from nrs_design.search.period import NOTHING_GROWS, WORDS, powers
from nrs_design.search.step_graph import StepGraph

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
            signal = _in_a_row(graph.sequence(word)[0])
            yield from powers(system, signal, (), growth ** len(word))
        return NOTHING_GROWS
    first, others = (distinct_modes(on_turn(system, clock, kind).modes) for kind in clock.kinds)
    rest = clock.length - 1
    rounds = [
        (float(np.abs(np.linalg.eigvals(whole)).max()), (a.name, b.name), whole)
        for (a, A), (b, B) in product(first, others)
        for whole in [np.linalg.matrix_power(B, rest) @ A]
    ]
    rounds.sort(key=lambda item: -item[0])
    matrices = np.array([whole for _, _, whole in rounds[:LETTERS]])
    scaled = scale_states(matrices, family.exponents)
    graph = StepGraph.free([names[0] for _, names, _ in rounds[:LETTERS]], scaled)
    for word, growth in best_words(graph, family.allowance, 1.0):
        signal = _signal([rounds[i][1] for i in word], rest)
        yield from powers(system, signal, (), growth ** len(word))
    return NOTHING_GROWS


def turns_graph(family: Family, clock: Clock) -> StepGraph:
    """Return the steps that an automaton allows, of modes that differ by no more than rounding."""
    modes = [
        (mode.name, A, kind)
        for kind in clock.kinds
        for mode, A in distinct_modes(on_turn(family.system, clock, kind).modes)
    ]
    texts, matrices, kinds = zip(*modes, strict=True)
    scaled = scale_states(np.array(matrices), family.exponents)
    return StepGraph.of_clock(clock, texts, scaled, kinds)


def _in_a_row(steps: Steps) -> Steps:
    """Join steps in one mode that follow each other."""
    runs = groupby(steps, key=lambda step: step[0])
    return tuple((name, sum((count for _, count in run), Fraction(0))) for name, run in runs)


def _signal(rounds: list[tuple[str, str]], rest: int) -> Steps:
    pairs = (((a, Fraction(1)), (b, Fraction(rest))) for a, b in rounds)
    return tuple(step for pair in pairs for step in pair)
