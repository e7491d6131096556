"""Search along the elementary cycles of the graph of switches, the shortest ones first.

By hand, as SciPy lists no cycles, and a package of graphs would be needed for nothing else.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import islice

import numpy as np

from nrs_design.search.graph import Array, Cycle, Graph, Jump
from nrs_design.search.structure import reachable
from nrs_design.work import Allowance

MAX_CYCLES = 120
MAX_LENGTH = 64
MAX_STEPS = 200_000
# Times of one leg after the other are changed so often, for cycles of three legs and more.
SWEEPS = 4
# How many of the fastest growing cycles are given out.
STARTS = 4


def growing_cycles(graph: Graph, allowance: Allowance) -> Iterator[tuple[Cycle, Array]]:
    """Yield the elementary cycles that seem to grow the most, or to decay the least.

    With each, the best times found before its jumps. When the work is used up, those that have been
    looked at are compared.
    """
    scanned: list[tuple[float, Cycle, Array]] = []
    for cycle in islice(elementary_cycles(graph.jumps), MAX_CYCLES):
        counts = [len(graph.times[mode]) for mode in graph.modes(cycle)]
        looks = counts[0] * counts[1] if len(cycle) == 2 else SWEEPS * sum(counts)
        cost = graph.cost(looks * len(cycle))
        if scanned and not allowance.affords(cost):
            break
        allowance.take(cost, f"looking at a cycle of {len(cycle)} modes")
        times = _best_pair(graph, cycle) if len(cycle) == 2 else _best_times(graph, cycle)
        scanned.append((float(graph.growth(cycle, times)), cycle, times))
    scanned.sort(key=lambda item: -item[0])
    yield from ((cycle, times) for _, cycle, times in scanned[:STARTS])


def elementary_cycles(jumps: Sequence[Jump]) -> Iterator[Cycle]:
    """Yield the cycles that visit no mode twice, by increasing length, each once.

    A cycle begins with its first mode. The search ends after a bounded number of steps.
    """
    leaving: dict[int, list[int]] = {}
    for k in _returning(jumps):
        leaving.setdefault(jumps[k].source, []).append(k)
    steps = iter(range(MAX_STEPS))
    for length in range(2, min(len(leaving), MAX_LENGTH) + 1):
        for start in sorted(leaving):
            for k in leaving[start]:
                yield from _closed((k,), jumps, leaving, length, steps)


def _closed(
    path: Cycle,
    jumps: Sequence[Jump],
    leaving: Mapping[int, list[int]],
    length: int,
    steps: Iterator[int],
) -> Iterator[Cycle]:
    """Yield the cycles of one length that begin with a path; all modes come after the first."""
    visited, end = [jumps[k].source for k in path], jumps[path[-1]].target
    if next(steps, None) is None:
        return
    if len(path) == length:
        if end == visited[0]:
            yield path
    elif end > visited[0] and end not in visited:
        for k in leaving[end]:
            yield from _closed((*path, k), jumps, leaving, length, steps)


def _returning(jumps: Sequence[Jump]) -> list[int]:
    """Return the jumps that lie on some cycle: both modes reach each other."""
    size = 1 + max((max(jump.source, jump.target) for jump in jumps), default=0)
    links = np.zeros((size, size), dtype=bool)
    for jump in jumps:
        links[jump.source, jump.target] = True
    reaches = reachable(links)
    return [k for k, jump in enumerate(jumps) if reaches[jump.target, jump.source]]


def _best_pair(graph: Graph, cycle: Cycle) -> Array:
    """Return the best of all pairs of times."""
    grids = np.meshgrid(*(graph.times[mode] for mode in graph.modes(cycle)), indexing="ij")
    mesh = np.stack(grids, axis=-1).reshape(-1, 2)
    return np.asarray(mesh[int(graph.growth(cycle, mesh).argmax())])


def _best_times(graph: Graph, cycle: Cycle) -> Array:
    """Start where all times are equally long, and change one after the other."""
    grids = [graph.times[mode] for mode in graph.modes(cycle)]
    count = max(map(len, grids))
    starts = np.array([[grid[min(k, len(grid) - 1)] for grid in grids] for k in range(count)])
    times = starts[int(graph.growth(cycle, starts).argmax())]
    for _ in range(SWEEPS):
        before = times
        for leg, grid in enumerate(grids):
            tried = np.tile(times, (len(grid), 1))
            tried[:, leg] = grid
            times = tried[int(graph.growth(cycle, tried).argmax())]
        if np.array_equal(times, before):
            break
    return np.asarray(times)
