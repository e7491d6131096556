"""Admissible switches with their resets, and times between them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.structure import reachable
from nrs_design.search.work import Allowance, Cost

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
# Indices of consecutive jumps; the last jump leads to the source of the first.
Cycle = tuple[int, ...]

TIMES = 48
# Work for the eigenvalues of a product, and per multiplication in them.
PER_PRODUCT = 2e-6
PER_OPERATION = 3e-8
# Entries of the products that are looked at together.
CHUNK_ENTRIES = 2_000_000
# Time between growing resets, relative to the shortest other time.
BRIEF = 1e-5
# Moves a factor per step off zero, of which there is no logarithm.
LEAST_FACTOR = 1e-12
# Most steps beyond the shortest stay that are tried.
LONGEST_STAY = 2000
MAX_CYCLES = 120
MAX_LENGTH = 64
MAX_STEPS = 200_000
# Number of sweeps over the times of a cycle of three legs or more.
SWEEPS = 4
# Number of fastest growing cycles that are returned.
STARTS = 8


@dataclass(frozen=True)
class Jump:
    """One way from a mode to another: their indices, which reset it is, and its matrix."""

    source: int
    target: int
    way: int
    map: Array


@dataclass(frozen=True)
class Graph:
    """Modes, the jumps between them, and times (s, or steps) to try in each mode."""

    matrices: Array  # Shape (m, n, n)
    # values, vectors, inverses: of the modes; a search needs many exponentials, not perfect ones.
    # In discrete time the values are logarithms: whole times give powers.
    values: ComplexArray
    vectors: ComplexArray
    inverses: ComplexArray
    jumps: tuple[Jump, ...]  # All that are allowed at one value of a constant parameter
    # shortest, longest: shape (m,). Bounds of the time in each mode; infinite without a bound.
    shortest: Array
    longest: Array
    times: tuple[Array, ...]  # Admissible times in each mode, in order

    @classmethod
    def of(cls, system: SwitchedSystem, matrices: Array) -> Graph:
        """Read the rules of a system with modes of one size.

        The modes may be scaled; they are those of the system itself if there are resets.
        """
        values, vectors = np.linalg.eig(matrices.astype(complex))
        # A defective mode is moved off its defect a little; the exact check is what counts.
        if (np.linalg.cond(vectors) > 1e10).any():
            rng = np.random.default_rng(0)
            noise = 1e-6 * np.abs(matrices).max() * rng.standard_normal(matrices.shape)
            values, vectors = np.linalg.eig(matrices + noise)
        if discrete := system.time is Time.DISCRETE:
            values = np.log(values + LEAST_FACTOR)
        sizes = np.abs(values)
        fastest = float(sizes.max()) or 1.0
        slowest = max(float(sizes.min()), 1e-6 * fastest)
        # Beyond the shortest time, up to where the modes have decayed.
        beyond = np.concatenate([[0.0], np.geomspace(0.02 / fastest, 20 / slowest, TIMES)])
        if system.switching.resets:
            # Resets may grow by less than modes decay in any other of these times.
            beyond = np.insert(beyond, 1, BRIEF * beyond[1])
        if discrete:
            beyond = np.unique(np.rint(beyond.clip(max=LONGEST_STAY)))
        shortest, longest = stay_bounds(system)
        times = tuple(
            np.array([t for t in low + beyond if 0 < t < high] + [high] * int(high < np.inf))
            for low, high in zip(shortest, longest, strict=True)
        )
        inverses = np.linalg.inv(vectors)
        return cls(matrices, values, vectors, inverses, jumps_of(system), shortest, longest, times)

    def flow(self, mode: int, times: Array) -> ComplexArray:
        """Return ``exp(A t)`` for all times t; shape (..., n, n)."""
        factors = np.exp(self.values[mode] * times[..., None])
        return np.asarray((self.vectors[mode] * factors[..., None, :]) @ self.inverses[mode])

    def modes(self, cycle: Cycle) -> list[int]:
        """Return the modes of a cycle in order."""
        return [self.jumps[k].source for k in cycle]

    def admissible(self, cycle: Cycle, times: Array) -> Array:
        """Return the nearest times that every mode of the cycle allows."""
        modes = self.modes(cycle)
        return np.asarray(np.clip(times, self.shortest[modes], self.longest[modes]))

    def cost(self, products: int) -> Cost:
        """Predict what looking at the growth of so many products takes."""
        return Cost(products * (PER_PRODUCT + PER_OPERATION * self.matrices[0].size ** 1.5))

    def growth(self, cycle: Cycle, times: Array) -> Array:
        """Return the growth per time of periodic signals; times of shape (..., legs)."""
        chunk = max(1, CHUNK_ENTRIES // self.matrices[0].size)
        if times.ndim > 1 and len(times) > chunk:
            parts = [self.growth(cycle, times[k : k + chunk]) for k in range(0, len(times), chunk)]
            return np.concatenate(parts)
        product: Array | ComplexArray = np.eye(len(self.matrices[0]))
        for leg, k in enumerate(cycle):
            jump = self.jumps[k]
            product = jump.map @ (self.flow(jump.source, times[..., leg]) @ product)
        radii = np.maximum(spectral_radii(product), 1e-300)
        return np.asarray(np.log(radii) / np.maximum(times.sum(axis=-1), 1e-300))


def stay_bounds(system: SwitchedSystem) -> tuple[Array, Array]:
    """Return the shortest and longest time of each mode; infinite without a bound."""
    stays = system.stays().values()
    longest = [np.inf if stay.longest is None else float(stay.longest) for stay in stays]
    return np.array([float(stay.shortest) for stay in stays]), np.array(longest)


def jumps_of(system: SwitchedSystem) -> tuple[Jump, ...]:
    """Return the switches that are allowed at one value of a constant parameter."""
    index = {mode.name: k for k, mode in enumerate(system.modes)}
    share_a_corner = system.switching.share_a_corner
    jumps: list[Jump] = []
    identity = np.eye(system.order)
    ways: dict[tuple[int, int], int] = {}
    for edge in system.edges():
        if share_a_corner((edge.source.name, edge.target.name)):
            pair = index[edge.source.name], index[edge.target.name]
            ways[pair] = ways.get(pair, -1) + 1
            map_ = identity if edge.map is None else np.array(edge.map.floats())
            jumps.append(Jump(*pair, ways[pair], map_))
    return tuple(jumps)


def spectral_radii(products: ComplexArray | Array) -> Array:
    """Return the spectral radius of every matrix; zero where floating point has overflowed."""
    finite = np.isfinite(products).all(axis=(-1, -2), keepdims=True)
    safe = np.where(finite, products, 0)
    return np.asarray(np.abs(np.linalg.eigvals(safe)).max(axis=-1))


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
    """Start from equal times, and optimize the times one by one."""
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
