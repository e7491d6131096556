"""Search for a cycle of modes in discrete time that keeps the rules and along which states grow."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from math import ceil, exp, log

import numpy as np
from numpy.typing import NDArray

from nrs_design.certificates.search.balance import mean_norm_coordinates
from nrs_design.switched.system import SwitchedSystem, Time

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Order = tuple[int, ...]
Cycle = tuple[Order, Order, float]

MAX_WORDS = 20_000
MAX_WORD_LENGTH = 16
# Walks: how many are carried on, how long they get, and how many of each length are refined.
BEAM = 150
MAX_LEGS = 8
CLOSED = 4
# Steps beyond the dwell time that a leg may have: few, and then up to where a mode has decayed.
FIBONACCI = (0, 1, 2, 3, 5, 8, 13, 21, 34, 55, 89, 144, 233, 377, 610, 987)
DECAYED = 1e-3
CHANGES = (1, 2, 4, 8, -1, -2, -4, -8)
ROUNDS = 40


def growing_words(matrices: Array) -> Iterator[tuple[Order, float]]:
    """Yield for each length the word with the largest spectral radius, where any may follow any.

    Parameters
    ----------
    matrices : ndarray, shape (m, n, n)
        The modes.

    Yields
    ------
    tuple
        The modes of the word in order, and its spectral radius.
    """
    m, length = len(matrices), 1
    while length < MAX_WORD_LENGTH and m ** (length + 1) <= MAX_WORDS:
        length += 1
        words = np.array(list(product(range(m), repeat=length)))
        monodromy = matrices[words[:, 0]]
        for column in words.T[1:]:
            monodromy = matrices[column] @ monodromy
        radius = np.abs(np.linalg.eigvals(monodromy)).max(axis=1)
        best = int(radius.argmax())
        yield tuple(int(i) for i in words[best]), float(radius[best])


def growing_walks(system: SwitchedSystem, matrices: Array) -> Iterator[Cycle]:
    """Yield cycles that keep dwell time, transitions and constant parameters, and seem to grow.

    Walks from mode to mode are carried on where they can make the most of a state per step; those
    that close to a cycle with the largest growth have their numbers of steps refined.

    Parameters
    ----------
    system : SwitchedSystem
        In discrete time, with its rules.
    matrices : ndarray, shape (m, n, n)
        Its modes; those of the system itself if there are resets.

    Yields
    ------
    tuple
        The modes in order, the number of steps in each, and the spectral radius.
    """
    graph = _Graph.of(system, matrices)
    walks = graph.first_legs()
    for _ in range(MAX_LEGS - 1):
        walks = graph.extended(walks.best(graph.growth(walks), BEAM))
        if not len(walks.orders):
            return
        rates = graph.rates(walks)
        closable = np.flatnonzero(rates > -np.inf)
        for k in closable[np.argsort(-rates[closable], kind="stable")][:CLOSED]:
            order = tuple(int(i) for i in walks.orders[k])
            counts, rate = graph.refined(order, tuple(int(i) for i in walks.counts[k]))
            if rate > 0:
                yield order, counts, exp(rate * sum(counts))


@dataclass(frozen=True)
class _Walks:
    """Walks of equal length: modes and steps, shape (w, legs), and products, shape (w, n, n)."""

    orders: Indices
    counts: Indices
    products: Array

    def best(self, value: Array, limit: int) -> _Walks:
        kept = np.argsort(-value, kind="stable")[:limit]
        return _Walks(self.orders[kept], self.counts[kept], self.products[kept])


@dataclass(frozen=True)
class _Graph:
    """Modes with their powers, and the allowed switches between them with their resets."""

    matrices: Array
    coordinates: Array
    jumps: dict[tuple[int, int], Array]
    dwell: int
    counts: Indices
    powers: Array

    @classmethod
    def of(cls, system: SwitchedSystem, matrices: Array) -> _Graph:
        dwell = max(1, ceil(system.switching.dwell_time))
        radius = float(np.abs(np.linalg.eigvals(matrices)).max())
        longest = log(DECAYED) / log(radius) if 0 < radius < 1 else FIBONACCI[-1]
        counts = np.array([dwell + k for k in FIBONACCI if k <= max(longest, 3)])
        powers = [[np.linalg.matrix_power(A, int(k)) for k in counts] for A in matrices]
        coordinates = mean_norm_coordinates(matrices, Time.DISCRETE)
        return cls(matrices, coordinates, _jumps(system), dwell, counts, np.array(powers))

    def first_legs(self) -> _Walks:
        m, K = self.powers.shape[:2]
        orders, counts = np.repeat(np.arange(m), K)[:, None], np.tile(self.counts, m)[:, None]
        return _Walks(orders, counts, self.powers.reshape(m * K, *self.matrices.shape[1:]))

    def extended(self, walks: _Walks) -> _Walks:
        """Return every walk with one more leg."""
        K, n = len(self.counts), self.matrices.shape[1]
        parts = []
        for (source, target), jump in self.jumps.items():
            rows = np.flatnonzero(walks.orders[:, -1] == source)
            reached = jump @ walks.products[rows]
            products = (self.powers[target][None] @ reached[:, None]).reshape(-1, n, n)
            orders = np.column_stack(
                [np.repeat(walks.orders[rows], K, axis=0), np.full(len(rows) * K, target)]
            )
            counts = np.column_stack(
                [np.repeat(walks.counts[rows], K, axis=0), np.tile(self.counts, len(rows))]
            )
            parts.append((orders, counts, products))
        if not parts:
            return _Walks(walks.orders[:0], walks.counts[:0], walks.products[:0])
        return _Walks(*(np.concatenate(arrays) for arrays in zip(*parts, strict=True)))

    def growth(self, walks: _Walks) -> Array:
        """Return how much each walk can make of a state, per step, as a logarithm."""
        inner = np.linalg.inv(self.coordinates) @ walks.products @ self.coordinates
        size = np.linalg.norm(inner, axis=(1, 2))
        return np.asarray(np.log(size) / walks.counts.sum(axis=1))

    def rates(self, walks: _Walks) -> Array:
        """Return how fast states grow per step when a walk is repeated; -inf if it cannot be."""
        rates = np.full(len(walks.orders), -np.inf)
        for (source, target), jump in self.jumps.items():
            ends = (walks.orders[:, -1] == source) & (walks.orders[:, 0] == target)
            if ends.any():
                values = np.linalg.eigvals(jump @ walks.products[ends])
                rates[ends] = np.log(np.abs(values).max(axis=1)) / walks.counts[ends].sum(axis=1)
        return rates

    def rate_of(self, order: Order, counts: Order) -> float:
        product_ = np.eye(self.matrices.shape[1])
        for mode, following, count in zip(order, (*order[1:], order[0]), counts, strict=True):
            leg = np.linalg.matrix_power(self.matrices[mode], count)
            product_ = self.jumps[mode, following] @ leg @ product_
        radius = float(np.abs(np.linalg.eigvals(product_)).max())
        return log(radius) / sum(counts) if radius > 0 else -np.inf

    def refined(self, order: Order, counts: Order) -> tuple[Order, float]:
        """Change the number of steps of one leg at a time while that helps."""
        best, longest = self.rate_of(order, counts), 2 * int(self.counts[-1])
        for _ in range(ROUNDS):
            before = best
            for leg, change in product(range(len(counts)), CHANGES):
                count = min(max(self.dwell, counts[leg] + change), longest)
                changed = (*counts[:leg], count, *counts[leg + 1 :])
                if (rate := self.rate_of(order, changed)) > best:
                    counts, best = changed, rate
            if best <= before:
                break
        return counts, best


def _jumps(system: SwitchedSystem) -> dict[tuple[int, int], Array]:
    """Return the resets of the allowed switches, at one end of a constant parameter."""
    index = {mode.name: k for k, mode in enumerate(system.modes)}
    ends = {name: end for pair in system.switching.fixed_ends for end, name in enumerate(pair)}
    jumps = {}
    for source, target in system.transitions():
        reset = system.reset_map(source, target)
        if ends.get(source.name) == ends.get(target.name):
            jump = np.eye(system.order) if reset is None else np.array(reset.floats())
            jumps[index[source.name], index[target.name]] = jump
    return jumps
