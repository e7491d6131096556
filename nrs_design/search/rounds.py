"""Search for a growing signal of whole rounds, or of missed deadlines (untrusted)."""

from __future__ import annotations

from fractions import Fraction
from itertools import groupby

import numpy as np

from nrs_design.proof.clock import on_turn
from nrs_design.proof.evidence import GrowingSequence
from nrs_design.proof.switching import Clock
from nrs_design.search.balance import scale_states
from nrs_design.search.branches import best_words
from nrs_design.search.candidates import Candidates
from nrs_design.search.family import Family, distinct_modes
from nrs_design.search.period import NOTHING_GROWS, WORDS, powers
from nrs_design.search.step_graph import StepGraph


def search_rounds(family: Family) -> Candidates[GrowingSequence]:
    """Search for a word of steps that modes may take in turn."""
    system, clock = family.system, family.system.clock
    if clock is None:
        return NOTHING_GROWS
    graph = turns_graph(family, clock)
    for word, growth in best_words(graph, family.allowance.part(WORDS), 1.0):
        runs = groupby(graph.sequence(word)[0], key=lambda step: step[0])
        signal = tuple((name, sum((count for _, count in run), Fraction(0))) for name, run in runs)
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
