"""Search for a periodic switching signal along which a solution grows."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import chain, groupby
from math import ceil, log, log2

import numpy as np
from numpy.typing import NDArray

from nrs_design.certificates.evidence import UnstablePeriod
from nrs_design.certificates.search.balance import mean_norm_coordinates
from nrs_design.certificates.search.cycle import growing_walks, growing_words
from nrs_design.switched.system import SwitchedSystem, Time

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

DWELLS = 48
MAX_PAIRS = 60
STARTS = 4
GREEDY_STEPS = 3000
GREEDY_PERIODS = (2, 3, 4, 6, 8)
DWELL_BITS = (8, 12, 16, 24, 40)


def find_growing_period(system: SwitchedSystem, matrices: Array) -> UnstablePeriod | None:
    """Search for a period with a spectral radius above one, and enclose it rigorously.

    Parameters
    ----------
    system : SwitchedSystem
        Exact modes.
    matrices : ndarray, shape (m, n, n)
        The same in floating point, perhaps scaled.
    """
    if system.time is Time.DISCRETE:
        return _find_cycle(system, matrices)
    flows = _Flows.of(matrices)
    shortest = float(system.switching.dwell_time)
    candidates = _candidates(flows, _allowed_pairs(system), _grid(matrices), shortest)
    if system.switching.is_arbitrary:
        candidates = chain(candidates, _greedy_candidates(flows, matrices))
    for order, dwells in candidates:
        for bits in DWELL_BITS:
            steps = tuple(
                (system.modes[i].name, max(_short(dwell, bits), system.switching.dwell_time))
                for i, dwell in zip(order, dwells, strict=True)
            )
            if evidence := _enclose(system, steps, _period_radius(flows, order, steps)):
                return evidence
    return None


def _find_cycle(system: SwitchedSystem, matrices: Array) -> UnstablePeriod | None:
    """Search in discrete time: all short words, or walks that keep the rules if there are any."""
    if system.switching.is_arbitrary:
        for word, radius in growing_words(matrices):
            steps = tuple((system.modes[i].name, Fraction(1)) for i in word)
            if evidence := _enclose(system, steps, radius):
                return evidence
        return None
    if system.switching.resets:
        # The scaled modes of a search do not fit the resets.
        matrices = np.array([mode.A.floats() for mode in system.modes])
    for order, counts, radius in growing_walks(system, matrices):
        names = [system.modes[i].name for i in order]
        steps = tuple(zip(names, map(Fraction, counts), strict=True))
        if evidence := _enclose(system, steps, radius):
            return evidence
    return None


def _allowed_pairs(system: SwitchedSystem) -> list[tuple[int, int]]:
    """Return the pairs of modes that may follow each other both ways, at one parameter value."""
    index = {mode.name: k for k, mode in enumerate(system.modes)}
    switches = {(index[a.name], index[b.name]) for a, b in system.transitions()}
    ends = {name: end for pair in system.switching.fixed_ends for end, name in enumerate(pair)}
    return [
        (i, j)
        for i, j in sorted(switches)
        if i < j
        and (j, i) in switches
        and ends.get(system.modes[i].name) == ends.get(system.modes[j].name)
    ][:MAX_PAIRS]


def _enclose(
    system: SwitchedSystem, steps: tuple[tuple[str, Fraction], ...], radius: float
) -> UnstablePeriod | None:
    """Try powers from where the trace should exceed n."""
    if not radius > 1:
        return None
    first = max(0, ceil(log2(log(2 * system.order) / log(radius))))
    for doublings in range(first, first + 4):
        evidence = UnstablePeriod(steps, doublings)
        if evidence.find_fault(system) is None:
            return evidence
    return None


def _period_radius(
    flows: _Flows, order: Sequence[int], steps: tuple[tuple[str, Fraction], ...]
) -> float:
    dwells = np.array([float(dwell) for _, dwell in steps])
    return float(np.exp(flows.growth(order, dwells) * dwells.sum()))


def _short(dwell: float, bits: int) -> Fraction:
    """Round a dwell time to so many significant bits."""
    shift = bits - int(np.frexp(dwell)[1])
    return Fraction(round(Fraction(dwell) * Fraction(2) ** shift)) / Fraction(2) ** shift


@dataclass(frozen=True)
class _Flows:
    """Exponentials of the modes, by their eigenvectors: a search needs many, not perfect ones."""

    values: ComplexArray
    vectors: ComplexArray
    inverses: ComplexArray

    @classmethod
    def of(cls, matrices: Array) -> _Flows:
        values, vectors = np.linalg.eig(matrices.astype(complex))
        # A defective mode is moved off its defect a little; the exact check is what counts.
        if (np.linalg.cond(vectors) > 1e10).any():
            rng = np.random.default_rng(0)
            noise = 1e-6 * np.abs(matrices).max() * rng.standard_normal(matrices.shape)
            values, vectors = np.linalg.eig(matrices + noise)
        return cls(values, vectors, np.linalg.inv(vectors))

    def at(self, mode: int, dwells: Array) -> ComplexArray:
        """Return ``exp(A t)`` for all dwell times t; shape (..., n, n)."""
        factors = np.exp(self.values[mode] * dwells[..., None])
        return np.asarray((self.vectors[mode] * factors[..., None, :]) @ self.inverses[mode])

    def growth(self, order: Sequence[int], dwells: Array) -> Array:
        """Return the growth rate in 1/s of periodic signals; dwells of shape (..., steps)."""
        monodromy = self.at(order[0], dwells[..., 0])
        for k, mode in enumerate(order[1:], start=1):
            monodromy = self.at(mode, dwells[..., k]) @ monodromy
        radius = np.abs(np.linalg.eigvals(monodromy)).max(axis=-1)
        period = np.maximum(dwells.sum(axis=-1), 1e-300)
        return np.asarray(np.log(np.maximum(radius, 1e-300)) / period)


def _candidates(
    flows: _Flows, pairs: list[tuple[int, int]], grid: Array, shortest: float
) -> Iterator[tuple[tuple[int, ...], Array]]:
    """Yield signals that grow in floating point: two modes in turn, then four steps."""
    times = np.concatenate([[shortest], shortest + grid]) if shortest else grid
    mesh = np.stack(np.meshgrid(times, times, indexing="ij"), axis=-1).reshape(-1, 2)
    scanned = []
    for pair in pairs:
        growth = flows.growth(pair, mesh)
        best = int(growth.argmax())
        scanned.append((float(growth[best]), pair, mesh[best]))
    for growth_rate, pair, dwells in sorted(scanned, key=lambda item: -item[0])[:STARTS]:
        if growth_rate > 0:
            yield pair, dwells
        four = np.concatenate([dwells * 1.2, dwells * 0.8])
        for order, start in ((pair, dwells), ((*pair, *pair), four)):
            refined = _refine(flows, order, start, shortest)
            if flows.growth(order, refined) > 0:
                yield order, refined


def _greedy_candidates(flows: _Flows, matrices: Array) -> Iterator[tuple[tuple[int, ...], Array]]:
    """Yield signals with more steps: what an adversary settles into that always picks the worst.

    It maximizes the mean of the modes' own norms after each short step. Its last few dwell times
    are taken as a period, and refined.
    """
    inverse = np.linalg.inv(mean_norm_coordinates(matrices, Time.CONTINUOUS))
    step = 0.05 / float(np.abs(np.linalg.eigvals(matrices)).max())
    transitions = [flows.at(k, np.array(step)).real for k in range(len(matrices))]
    x, chosen = inverse[0] + 0.1, []
    for _ in range(GREEDY_STEPS):
        images = [E @ x for E in transitions]
        chosen.append(int(np.argmax([np.linalg.norm(inverse @ y) for y in images])))
        x = images[chosen[-1]] / np.linalg.norm(images[chosen[-1]])
    runs = [(mode, len(list(group))) for mode, group in groupby(chosen)][1:-1]
    for length in GREEDY_PERIODS:
        if len(runs) < length:
            return
        order = tuple(mode for mode, _ in runs[-length:])
        dwells = step * np.array([count for _, count in runs[-length:]], dtype=float)
        refined = _refine(flows, order, dwells, 0.0)
        if flows.growth(order, refined) > 0:
            yield order, refined


def _grid(matrices: Array) -> Array:
    """Return times from far below to far above the modes' own time scales."""
    speeds = np.abs(np.linalg.eigvals(matrices))
    longest = 20 / max(speeds.min(), 1e-6 * speeds.max())
    return np.geomspace(0.02 / speeds.max(), longest, DWELLS)


def _refine(flows: _Flows, order: Sequence[int], dwells: Array, shortest: float) -> Array:
    """Climb from a start, over the logarithms of the times beyond the shortest."""
    from scipy.optimize import minimize

    beyond = np.maximum(dwells - shortest, 1e-6 * dwells.max())

    def decline(logs: Array) -> float:
        return -float(flows.growth(order, shortest + np.exp(logs)))

    best = minimize(
        decline,
        np.log(beyond),
        method="Nelder-Mead",
        options={"maxiter": 400, "xatol": 1e-6, "fatol": 1e-12},
    )
    return np.asarray(shortest + np.exp(best.x))
