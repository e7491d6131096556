"""Search for growing cycles that may visit a mode more than once: walks, carried on greedily."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.mode import Time
from nrs_design.search.balance import mean_norm_coordinates
from nrs_design.search.flows import spectral_radii
from nrs_design.search.graph import Array, Cycle, Graph
from nrs_design.work import Allowance, Cost

Indices = NDArray[np.int64]

# How many walks are carried on, how long they get, and how many of each length are given out.
BEAM = 150
MAX_LEGS = 8
CLOSED = 4
# Where there are more ways to switch, only elementary cycles are tried.
MAX_JUMPS = 20_000
# In continuous time, every so many of the times to try in a mode are enough.
STRIDE = 4


def growing_walks(graph: Graph, allowance: Allowance) -> Iterator[tuple[Cycle, Array]]:
    """Yield closed walks that seem to grow the most per time, the shortest first.

    With each, the times before its jumps. Walks from mode to mode are carried on where they can
    make the most of a state per time.
    """
    if len(graph.jumps) > MAX_JUMPS:
        return
    beam = _Beam.of(graph)
    walks = beam.first_legs()
    for _ in range(MAX_LEGS - 1):
        allowance.require(beam.cost(), "walks through the graph of switches")
        walks = beam.extended(walks.best(beam.growth(walks), BEAM))
        if not len(walks.jumps):
            return
        allowance.charge(graph.cost(len(walks.jumps)).work)
        rates, closing = beam.rates(walks)
        closable = np.flatnonzero(rates > -np.inf)
        for k in closable[np.argsort(-rates[closable], kind="stable")][:CLOSED]:
            yield (*(int(i) for i in walks.jumps[k]), int(closing[k])), walks.times[k]


@dataclass(frozen=True)
class _Walks:
    """Walks of equal length: first and last mode, jumps, times and products of each."""

    ends: Indices
    jumps: Indices
    times: Array
    products: Array

    def best(self, value: Array, limit: int) -> _Walks:
        kept = np.argsort(-value, kind="stable")[:limit]
        return _Walks(self.ends[kept], self.jumps[kept], self.times[kept], self.products[kept])


@dataclass(frozen=True)
class _Beam:
    """A graph with times to try in each mode, what becomes of the state in them, and a norm."""

    graph: Graph
    times: tuple[Array, ...]
    powers: tuple[Array, ...]
    coordinates: Array

    @classmethod
    def of(cls, graph: Graph) -> _Beam:
        stride = STRIDE if graph.flows.time is Time.CONTINUOUS else 1
        times = tuple(grid[::stride] for grid in graph.times)
        powers = tuple(np.real(graph.flows.at(mode, grid)) for mode, grid in enumerate(times))
        return cls(graph, times, powers, _coordinates(graph))

    def cost(self) -> Cost:
        """Predict the memory for walks with one more leg: at most as if all were at one mode."""
        counts = np.zeros(len(self.times))
        for jump in self.graph.jumps:
            counts[jump.source] += len(self.times[jump.target])
        return Cost(0.0, 32 * BEAM * float(counts.max()) * self.powers[0][0].size)

    def first_legs(self) -> _Walks:
        modes = [k for k, times in enumerate(self.times) for _ in times]
        times = np.concatenate(self.times)[:, None]
        jumps = np.zeros((len(modes), 0), dtype=np.int64)
        return _Walks(np.column_stack([modes, modes]), jumps, times, np.concatenate(self.powers))

    def extended(self, walks: _Walks) -> _Walks:
        """Return every walk with one more leg."""
        parts = []
        for k, jump in enumerate(self.graph.jumps):
            rows = np.flatnonzero(walks.ends[:, 1] == jump.source)
            if not len(rows):
                continue
            times, powers = self.times[jump.target], self.powers[jump.target]
            products = powers[None] @ (jump.map @ walks.products[rows])[:, None]
            repeated = np.repeat(rows, len(times))
            added = np.full((len(repeated), 1), k)
            parts.append(
                _Walks(
                    np.column_stack([walks.ends[repeated, 0], np.full(len(repeated), jump.target)]),
                    np.hstack([walks.jumps[repeated], added]),
                    np.column_stack([walks.times[repeated], np.tile(times, len(rows))]),
                    products.reshape(-1, *products.shape[2:]),
                )
            )
        if not parts:
            return _Walks(walks.ends[:0], walks.jumps[:0], walks.times[:0], walks.products[:0])
        joined = ("ends", "jumps", "times", "products")
        return _Walks(*(np.concatenate([getattr(part, name) for part in parts]) for name in joined))

    def growth(self, walks: _Walks) -> Array:
        """Return how much each walk can make of a state, per time, as a logarithm."""
        inner = np.linalg.inv(self.coordinates) @ walks.products @ self.coordinates
        size = np.nan_to_num(np.linalg.norm(inner, axis=(1, 2)))
        total = np.maximum(walks.times.sum(axis=1), 1e-300)
        return np.asarray(np.log(np.maximum(size, 1e-300)) / total)

    def rates(self, walks: _Walks) -> tuple[Array, Indices]:
        """Return how fast states grow when a walk is repeated, -inf if it cannot, and the jump."""
        rates = np.full(len(walks.jumps), -np.inf)
        closing = np.zeros(len(walks.jumps), dtype=np.int64)
        rows_between = self._rows_between(walks)
        for k, jump in enumerate(self.graph.jumps):
            rows = rows_between(jump.target, jump.source)
            if not len(rows):
                continue
            radii = np.maximum(spectral_radii(jump.map @ walks.products[rows]), 1e-300)
            found = np.log(radii) / np.maximum(walks.times[rows].sum(axis=1), 1e-300)
            better = found > rates[rows]
            rates[rows[better]], closing[rows[better]] = found[better], k
        return rates, closing

    def _rows_between(self, walks: _Walks) -> Callable[[int, int], Indices]:
        """Return what tells the walks from one mode to another; all are sorted once."""
        pairs = walks.ends @ np.array([len(self.times), 1])
        order = np.argsort(pairs, kind="stable")
        ordered = pairs[order]

        def rows(first: int, last: int) -> Indices:
            pair = first * len(self.times) + last
            begin, end = np.searchsorted(ordered, (pair, pair + 1))
            return order[begin:end]

        return rows


def _coordinates(graph: Graph) -> Array:
    """Return coordinates in which modes that may stay are nearly contractions, if there are any."""
    matrices = graph.flows.matrices[np.isinf(graph.longest)]
    if not len(matrices):
        return np.eye(graph.flows.matrices.shape[1])
    return mean_norm_coordinates(matrices, graph.flows.time)
