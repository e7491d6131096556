"""Words that grow the most, sought in the norms of forms that hardly let them (untrusted).

Of the rotations of a word there is one of which no beginning grows by less than the word, in any
norms of the nodes. The nearer what the norms allow is to the growth of the best word, the fewer
other words have such beginnings, and the longer are those that are found.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.evidence import GrowingSequence
from nrs_design.search.balance import round_coordinates
from nrs_design.search.branches import best_words
from nrs_design.search.candidates import Candidates
from nrs_design.search.drawing import Solution
from nrs_design.search.family import Family
from nrs_design.search.forms import FormsProgram
from nrs_design.search.memory import draw_memory, memories
from nrs_design.search.period import NOTHING_GROWS, powers
from nrs_design.search.step_graph import StepGraph
from nrs_design.work import Allowance

Array = NDArray[np.float64]

# Steps of a word, and the work of a program whose forms give the norms.
LONGEST, WORK = 400, 0.1
# The least growth that forms show is found to this share of what it is above that of a word.
SHARE, NEAR = 0.2, 1e-4
HALVINGS = 12
# What forms are to show at first, where a word that grows by one is sought, and then.
BOUNDS = (1.05, 1.5, 6.0)


def least_growth(
    program: FormsProgram, allowance: Allowance, low: float, high: float
) -> tuple[float, Solution] | None:
    """Return nearly the least growth per step that forms show, and them; None above a bound.

    In discrete time: `low` is a growth that some word has, `high` one that forms are to show.
    """
    if (solution := program.solve(high, allowance)) is None:
        return None
    best, bottom = (high, solution), low
    for _ in range(HALVINGS):
        if best[0] - bottom <= max(SHARE * (best[0] - low), NEAR * low):
            break
        middle = (best[0] + bottom) / 2
        found = program.solve(middle, allowance)
        bottom, best = (middle, best) if found is None else (bottom, (middle, found))
    return best


def words_in_norms(
    program: FormsProgram, solution: Solution, allowance: Allowance, floor: float
) -> Iterator[tuple[tuple[int, ...], float]]:
    """Yield closed words in the norms of forms, each of which grows more than all before it.

    A word is of edges in the graph of steps of the system, with its growth per step. The program is
    of quadratic forms that `draw_memory` drew. Words that grow by no more than the floor are not
    looked for; those for which work or memory do not suffice end the search.
    """
    system = program.drawing.system
    matrices = np.array([mode.A.floats() for mode in system.modes])
    steps = StepGraph.of(system, matrices)
    if steps is None or steps.has_choice:
        return
    index = {mode.name: k for k, mode in enumerate(system.modes)}
    graph, free = program.drawing.graph, system.switching.is_arbitrary
    own, places = _edges_of(steps, free=free), [node.place for node in graph.nodes]
    rows = list[tuple[int, int, int]]()
    for a, step, b in graph.edges_in_time(system):
        key = tuple(index[name] for name in ((step.mode,) if free else (places[a], places[b])))
        if key not in own:
            return  # A stay of several steps is none of this graph.
        rows.append((a, b, own[key]))
    order = np.argsort([a for a, *_ in rows], kind="stable")
    sources, targets, edges = np.array(rows)[order].T
    maps = np.array([program.every[k].M for k in order])
    none = np.zeros(len(rows), dtype=np.int64)
    lifted = StepGraph((), sources, targets, none, none, maps, len(places), has_choice=False)
    T = np.array([round_coordinates(Q) for Q in solution.forms])
    for word, growth in best_words(lifted, allowance, floor, T, LONGEST):
        yield tuple(int(edges[k]) for k in word), growth


def _edges_of(steps: StepGraph, *, free: bool) -> dict[tuple[int, ...], int]:
    """Return the edge of each mode, or of each pair of modes that follow each other."""
    every = range(len(steps.modes))
    if free:
        return {(int(steps.modes[k]),): k for k in every}
    if steps.count != len(steps.names):
        return {}
    return {(int(steps.sources[k]), int(steps.targets[k])): k for k in every}


def search_extremal_words(family: Family) -> Candidates[GrowingSequence]:
    """Search for a word that grows, in the norms of forms that remember some steps."""
    system, allowance = family.system, family.allowance
    fitting = [length for length, cost in memories(system).items() if cost.work <= WORK]
    if not fitting or not np.isfinite(family.matrices).all():
        return NOTHING_GROWS
    program = FormsProgram(draw_memory(system, fitting[-1]))
    for high in BOUNDS:
        if (found := least_growth(program, allowance, 1.0, high)) is not None:
            break
    else:
        return NOTHING_GROWS
    steps = StepGraph.of(system, np.array([mode.A.floats() for mode in system.modes]))
    if steps is not None:
        for word, growth in words_in_norms(program, found[1], allowance, 1.0):
            sequence, edges = steps.sequence(word)
            yield from powers(system, sequence, edges, growth ** len(word))
    return NOTHING_GROWS
