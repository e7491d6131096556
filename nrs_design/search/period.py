"""Search for a periodic switching signal along which a solution grows."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import chain, compress
from math import ceil, exp, isinf, log, log2

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.evidence import GrowingSequence
from nrs_design.proof.evidence.growth import Steps
from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Stay
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.acceptance import Candidate, Candidates
from nrs_design.search.branches import MOST_EDGES, StepGraph, best_words, turns_graph
from nrs_design.search.family import Family
from nrs_design.search.graph import Cycle, Graph, growing_cycles
from nrs_design.search.rates import digits
from nrs_design.search.work import Allowance, Cost

Array = NDArray[np.float64]
Signal = tuple[Cycle, Array]

FEWEST_BITS = 8
# Evaluations to refine the times of a cycle, and work of an evaluation for each jump.
LOOKS = 600
PER_LOOK = 4e-5
# Share of the remaining budget for words of single steps, or for words of stays on a grid.
WORDS = 0.3
NOTHING_GROWS = "no periodic signal tried makes solutions grow"
# Number of lengths of a stay; the shortest positive length, relative to the longest.
LENGTHS, BRIEF = 5, 1e-6


def search_period(family: Family) -> Candidates[GrowingSequence]:
    """Search for a period with a spectral radius above one."""
    system, allowance = family.system, family.allowance
    matrices = family.matrices
    if system.switching.resets:
        # The scaled modes of a search do not fit resets.
        matrices = np.array([mode.A.floats() for mode in system.modes])
    if stand_ins := family.stand_ins():
        kept = [mode.name in stand_ins.values() for mode in system.modes]
        few = tuple(compress(system.modes, kept))
        system = system.with_modes(few, system.states, system.switching)
        matrices = matrices[kept]
    if (steps := StepGraph.of(system, matrices)) is not None:
        for word, growth in best_words(steps, allowance.part(WORDS), 1.0):
            yield from powers(system, *steps.sequence(word), growth ** len(word))
    graph = Graph.of(system, matrices)
    for cycle, times in _signals(system, graph, allowance):
        yield from _roundings(system, graph, cycle, times)
        allowance.check()
    allowance.check()
    return NOTHING_GROWS


def _signals(system: SwitchedSystem, graph: Graph, allowance: Allowance) -> Iterator[Signal]:
    """Yield signals that grow in floating point."""
    is_continuous = system.time is Time.CONTINUOUS
    words = stay_words(graph, allowance.part(WORDS)) if is_continuous else ()
    for cycle, start in chain(words, growing_cycles(graph, allowance)):
        times = graph.admissible(cycle, start)
        if graph.growth(cycle, times) > 0:
            yield cycle, times
        looks = LOOKS * len(cycle)
        allowance.take(Cost(graph.cost(looks).work + PER_LOOK * looks), "refining a cycle")
        better = _refined(graph, cycle, times)
        if graph.growth(cycle, better) > 0:
            yield cycle, better


def _refined(graph: Graph, cycle: Cycle, times: Array) -> Array:
    """Climb from a start, over the logarithms of the times beyond the shortest."""
    from scipy.optimize import minimize

    modes = graph.modes(cycle)
    shortest, longest = graph.shortest[modes], graph.longest[modes]
    beyond = np.maximum(times - shortest, 1e-6 * times.max())

    def bounded(logs: Array) -> Array:
        return np.asarray(np.minimum(shortest + np.exp(logs), longest))

    def decline(logs: Array) -> float:
        return -float(graph.growth(cycle, bounded(logs)))

    best = minimize(
        decline,
        np.log(beyond),
        method="Nelder-Mead",
        options={"maxiter": 400, "xatol": 1e-6, "fatol": 1e-12},
    )
    return bounded(best.x)


def _roundings(
    system: SwitchedSystem, graph: Graph, cycle: Cycle, times: Array
) -> Iterator[Candidate[GrowingSequence]]:
    """Round times to few digits or whole steps, and keep them admissible."""
    names = [system.modes[mode].name for mode in graph.modes(cycle)]
    edges = tuple(graph.jumps[k].way for k in cycle)
    has_choice, stays = any(jump.way for jump in graph.jumps), system.stays()
    for bits in digits(FEWEST_BITS) if system.time is Time.CONTINUOUS else (0,):
        steps = tuple(
            (name, _admissible(stays[name], _short(float(time), bits)))
            for name, time in zip(names, times, strict=True)
        )
        floats = np.array([float(time) for _, time in steps])
        growth = float(graph.growth(cycle, floats) * floats.sum())
        yield from powers(system, steps, edges if has_choice else (), exp(min(growth, 700.0)))


def _admissible(stay: Stay, time: Fraction) -> Fraction:
    time = max(time, stay.shortest)
    return time if stay.longest is None else min(time, stay.longest)


def powers(
    system: SwitchedSystem, steps: Steps, edges: tuple[int, ...], radius: float
) -> Iterator[Candidate[GrowingSequence]]:
    """Yield a period with its powers from where the trace should exceed n.

    Nothing is yielded if the spectral radius over the period is not above one.
    """
    if not radius > 1 or isinf(radius):
        return
    first = max(0, ceil(log2(log(2 * system.order) / log(radius))))
    for doublings in range(first, first + 4):
        yield Candidate(GrowingSequence(steps, doublings, edges))


def _short(time: float, bits: int) -> Fraction:
    """Round a time to a number of significant bits; to at least one whole step for none."""
    if not bits:
        return max(Fraction(1), Fraction(round(time)))
    shift = bits - int(np.frexp(time)[1])
    return Fraction(round(Fraction(time) * Fraction(2) ** shift)) / Fraction(2) ** shift


def search_rounds(family: Family) -> Candidates[GrowingSequence]:
    """Search for a growing sequence of scheduled steps."""
    system, clock = family.system, family.system.clock
    if clock is None:
        return NOTHING_GROWS
    graph = turns_graph(family, clock)
    for word, growth in best_words(graph, family.allowance.part(WORDS), 1.0):
        yield from powers(system, *graph.sequence(word), growth ** len(word))
    return NOTHING_GROWS


def stay_words(graph: Graph, allowance: Allowance) -> Iterator[tuple[Cycle, Array]]:
    """Yield words that grow, each more than all before it; if none does, the best one.

    Nothing is yielded where no stay varies, or some have no longest length and no choice of resets.
    """
    varies, choice = graph.longest > graph.shortest, any(jump.way for jump in graph.jumps)
    if not varies.any() or (np.isinf(graph.longest).any() and not choice):
        return
    rows: list[tuple[int, int, int]] = []
    times, maps = list[float](), list[Array]()
    for k, jump in sorted(enumerate(graph.jumps), key=lambda item: item[1].source):
        for time in _lengths(graph, jump.source):
            rows.append((jump.source, jump.target, k))
            times.append(time)
            maps.append(jump.map @ graph.flow(jump.source, np.array(time)).real)
        if len(rows) > MOST_EDGES:
            return
    if not rows:
        return
    sources, targets, jumps = np.array(rows, dtype=np.int64).T
    steps = StepGraph((), sources, targets, sources, jumps, np.array(maps), len(varies), False)
    best: tuple[Cycle, Array] | None = None
    for word, growth in best_words(steps, allowance):
        # A signal begins with its first mode.
        start = min(range(len(word)), key=lambda k: int(sources[word[k]]))
        word = word[start:] + word[:start]
        best = tuple(int(jumps[k]) for k in word), np.array([times[k] for k in word])
        if growth > 1:
            yield best
    if best is not None and not growth > 1:
        yield best


def _lengths(graph: Graph, mode: int) -> Array:
    first, last = float(graph.shortest[mode]), float(graph.longest[mode])
    if isinf(last):
        return graph.times[mode][:LENGTHS]
    found = np.linspace(first, last, LENGTHS if last > first else 1)
    return np.asarray(np.maximum(found, BRIEF * last))
