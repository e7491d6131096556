"""Closed words of stays whose lengths are in intervals: on a grid, by branch and bound (untrusted).

Stays that grow the most often are at ends of their intervals, in an order that no single cycle
shows.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.mode import Time
from nrs_design.search.branches import best_words
from nrs_design.search.graph import Cycle, Graph
from nrs_design.search.step_graph import MOST_EDGES, StepGraph
from nrs_design.work import Allowance

Array = NDArray[np.float64]

# Lengths of a stay that are looked at; one of zero is none, and so long of the longest one instead.
LENGTHS, BRIEF = 5, 1e-6


def stay_words(graph: Graph, allowance: Allowance) -> Iterator[tuple[Cycle, Array]]:
    """Yield words that grow, each more than all before it; if none does, the best one.

    In continuous time; nothing is yielded where a stay has no longest length, or none varies.
    """
    varies = graph.longest > graph.shortest
    if graph.flows.time is Time.DISCRETE or np.isinf(graph.longest).any() or not varies.any():
        return
    rows: list[tuple[int, int, int]] = []
    times, maps = list[float](), list[Array]()
    for k, jump in sorted(enumerate(graph.jumps), key=lambda item: item[1].source):
        for time in _lengths(graph, jump.source):
            rows.append((jump.source, jump.target, k))
            times.append(time)
            maps.append(jump.map @ graph.flows.at(jump.source, np.array(time)).real)
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
    found = np.linspace(first, last, LENGTHS if last > first else 1)
    return np.asarray(np.maximum(found, BRIEF * last))
