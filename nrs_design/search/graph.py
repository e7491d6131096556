"""The switches that a search may take, with their resets, and how long it may stay in between."""

from __future__ import annotations

from dataclasses import dataclass
from math import log

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.work import Cost

Array = NDArray[np.float64]
# Jumps in order, each into the mode that the next one leaves; the last into that of the first.
Cycle = tuple[int, ...]

TIMES = 48
# Work for the eigenvalues of a product, and per multiplication in them.
PER_PRODUCT = 2e-6
PER_OPERATION = 3e-8
# Entries of the products that are looked at together.
CHUNK_ENTRIES = 2_000_000
# Steps beyond the dwell time that a stay may have: few, and then up to where a mode has decayed.
FIBONACCI = (0, 1, 2, 3, 5, 8, 13, 21, 34, 55, 89, 144, 233, 377, 610, 987)
DECAYED = 1e-3
# The time between resets that grow by themselves, over the shortest of the other times.
BRIEF = 1e-5
ComplexArray = NDArray[np.complex128]


@dataclass(frozen=True)
class Jump:
    """One way from a mode to another: their indices, which reset it is, and its matrix."""

    source: int
    target: int
    way: int
    map: Array


@dataclass(frozen=True)
class Graph:
    """Modes, the jumps between them, and times to try in each mode."""

    flows: Flows  # Of the modes
    jumps: tuple[Jump, ...]  # All that are allowed at one value of a constant parameter
    # shortest, longest: shape (m,). Bounds of the time in each mode; infinite where there is none.
    shortest: Array
    longest: Array
    times: tuple[Array, ...]  # Admissible times in each mode, in order

    @classmethod
    def of(cls, system: SwitchedSystem, matrices: Array) -> Graph:
        """Read the rules of a system with modes of one size.

        The modes may be scaled; they are those of the system itself if there are resets.
        """
        stays = system.stays().values()
        shortest = np.array([float(stay.shortest) for stay in stays])
        longest = np.array([np.inf if s.longest is None else float(s.longest) for s in stays])
        beyond = _times_beyond(matrices, np.isinf(longest), system.time)
        if system.switching.resets and system.time is Time.CONTINUOUS:
            # Resets may grow by less than modes decay in any other of these times.
            beyond = np.insert(beyond, 1, BRIEF * beyond[1])
        times = tuple(
            np.array([t for t in low + beyond if 0 < t < high] + [high] * int(high < np.inf))
            for low, high in zip(shortest, longest, strict=True)
        )
        return cls(Flows.of(matrices, system.time), _jumps(system), shortest, longest, times)

    def modes(self, cycle: Cycle) -> list[int]:
        """Return the modes of a cycle in order."""
        return [self.jumps[k].source for k in cycle]

    def admissible(self, cycle: Cycle, times: Array) -> Array:
        """Return the nearest times that every mode of the cycle allows."""
        if self.flows.time is Time.DISCRETE:
            times = np.round(times)
        modes = self.modes(cycle)
        return np.asarray(np.clip(times, self.shortest[modes], self.longest[modes]))

    def cost(self, products: int) -> Cost:
        """Predict what looking at the growth of so many products takes."""
        return Cost(products * (PER_PRODUCT + PER_OPERATION * self.flows.matrices[0].size ** 1.5))

    def growth(self, cycle: Cycle, times: Array) -> Array:
        """Return the growth per time of periodic signals; times of shape (..., legs)."""
        chunk = max(1, CHUNK_ENTRIES // self.flows.matrices[0].size)
        if times.ndim > 1 and len(times) > chunk:
            parts = [self.growth(cycle, times[k : k + chunk]) for k in range(0, len(times), chunk)]
            return np.concatenate(parts)
        product: Array | ComplexArray = np.eye(len(self.flows.matrices[0]))
        for leg, k in enumerate(cycle):
            jump = self.jumps[k]
            product = jump.map @ (self.flows.at(jump.source, times[..., leg]) @ product)
        radii = np.maximum(spectral_radii(product), 1e-300)
        return np.asarray(np.log(radii) / np.maximum(times.sum(axis=-1), 1e-300))


def _times_beyond(matrices: Array, lasting: NDArray[np.bool_], time: Time) -> Array:
    """Return times beyond the shortest one, up to where the modes that may stay have decayed."""
    values = np.abs(np.linalg.eigvals(matrices))
    if time is Time.CONTINUOUS:
        fastest = float(values.max()) or 1.0
        slowest = max(float(values.min()), 1e-6 * fastest)
        return np.concatenate([[0.0], np.geomspace(0.02 / fastest, 20 / slowest, TIMES)])
    radius = float(values[lasting].max(initial=0.0))
    decayed = log(DECAYED) / log(radius) if 0 < radius < 1 else FIBONACCI[-1]
    return np.array([k for k in FIBONACCI if k <= max(decayed, 3)], dtype=float)


def _jumps(system: SwitchedSystem) -> tuple[Jump, ...]:
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


@dataclass(frozen=True)
class Flows:
    """Exponentials of the modes, by their eigenvectors: a search needs many, not perfect ones.

    In discrete time, powers of the modes.
    """

    matrices: Array
    time: Time
    values: ComplexArray
    vectors: ComplexArray
    inverses: ComplexArray

    @classmethod
    def of(cls, matrices: Array, time: Time) -> Flows:
        """Decompose the modes; shape (m, n, n)."""
        values, vectors = np.linalg.eig(matrices.astype(complex))
        # A defective mode is moved off its defect a little; the exact check is what counts.
        if time is Time.CONTINUOUS and (np.linalg.cond(vectors) > 1e10).any():
            rng = np.random.default_rng(0)
            noise = 1e-6 * np.abs(matrices).max() * rng.standard_normal(matrices.shape)
            values, vectors = np.linalg.eig(matrices + noise)
        inverses = np.linalg.inv(vectors) if time is Time.CONTINUOUS else vectors
        return cls(matrices, time, values, vectors, inverses)

    def at(self, mode: int, times: Array) -> ComplexArray | Array:
        """Return ``exp(A t)``, or ``A^t``, for all times t; shape (..., n, n)."""
        if self.time is Time.DISCRETE:
            counts, places = np.unique(times, return_inverse=True)
            powers = [np.linalg.matrix_power(self.matrices[mode], int(k)) for k in counts]
            return np.asarray(np.array(powers)[places.reshape(np.shape(times))])
        factors = np.exp(self.values[mode] * times[..., None])
        return np.asarray((self.vectors[mode] * factors[..., None, :]) @ self.inverses[mode])


def spectral_radii(products: ComplexArray | Array) -> Array:
    """Return the spectral radius of every matrix; zero where floating point has overflowed."""
    finite = np.isfinite(products).all(axis=(-1, -2), keepdims=True)
    safe = np.where(finite, products, 0)
    return np.asarray(np.abs(np.linalg.eigvals(safe)).max(axis=-1))
