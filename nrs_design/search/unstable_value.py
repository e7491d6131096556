"""Search for a value of constant parameters, or an average of modes, that is not stable."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from itertools import combinations, islice, product

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.constant import find_odd_shares, system_at
from nrs_design.proof.evidence import GrowingSequence
from nrs_design.proof.evidence.growing_sequence import staying
from nrs_design.proof.mode import Time
from nrs_design.proof.spectrum import is_stable
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.acceptance import OUT_OF_RANGE, Candidate, Candidates
from nrs_design.search.family import Family
from nrs_design.search.period import search_period
from nrs_design.search.work import Allowance, Cost

Array = NDArray[np.float64]
Shares = tuple[Fraction, ...]

ENCLOSED = "not tried: what the corners enclose need not be attained"

# Values of a parameter that are tried, fewer where there are many modes or several parameters.
GRID, COARSE_GRID, EVALUATIONS = 257, 33, 200_000
FEWEST = 3
# Number of local maxima of the growth that are refined, and evaluations for each parameter.
PEAKS, CLOSELY = 16, 120
# Shorter shares first: they make shorter numbers in the certificate.
DENOMINATORS = (1, 4, 16, 64, 256, 2**12, 2**20, 2**32, 2**48)
# Work for the eigenvalues of a mode at a value, and per multiplication in them.
PER_MATRIX = 5e-6
PER_PRODUCT = 3e-8
# What rounding hides, relative to the size of the matrices.
SLACK = 1e-9
# Shares at which switching is examined, with the ends: no mixture rung covers the ends. One or two
# parameters are varied independently, more parameters together.
SHARES = (Fraction(1, 2), Fraction(1, 4), Fraction(3, 4), Fraction(0), Fraction(1))
# Averages of modes: shares of two, number of pairs, and number of others.
PAIR_SHARES, MAX_PAIRS, RANDOM_MIXTURES = 128, 300, 2000
# Entries of the averages that are looked at together.
CHUNK_ENTRIES = 2_000_000
AVERAGE_DENOMINATORS = (16, 64, 1024, 2**20)


def search_value(family: Family) -> Candidates[GrowingSequence]:
    """Scan the parameters' ranges for a mode that is not stable."""
    system, matrices = family.system, family.matrices
    if not np.isfinite(matrices).all():
        return OUT_OF_RANGE
    if (count := _count(system)) is None:
        return ENCLOSED
    slack = SLACK * max(float(np.abs(matrices).max()), 1.0)
    index = {mode.name: k for k, mode in enumerate(system.modes)}
    # Shape (sets, corners, n, n)
    corners = matrices[[[index[name] for name in c] for c in system.switching.fixed_ends]]
    fewest_values = COARSE_GRID if count == 1 else FEWEST
    fitting = int((EVALUATIONS / len(corners)) ** (1 / count))
    grid = np.linspace(0, 1, max(fewest_values, min(GRID, fitting)))
    values = len(grid) ** count
    looks = len(corners) * values + PEAKS * CLOSELY * count
    work = looks * (PER_MATRIX + PER_PRODUCT * corners.shape[-1] ** 3)
    family.allowance.take(Cost(work), f"looking at {values} values")
    found = False
    for k, start in _peaks(corners, grid, count, system.time):
        shares, growth = _refined(corners[k], start, float(grid[1]), system.time)
        if growth < -slack:
            continue
        for denominator in DENOMINATORS:
            short = tuple(Fraction(s).limit_denominator(denominator) for s in shares)
            for mode in system_at(system, short).modes:
                if not is_stable(mode.A, system.time):
                    found = True
                    yield Candidate(replace(staying(mode.name), shares=short))
    return None if found else "every mode is stable at every value tried"


def search_switching_at_values(family: Family) -> Candidates[GrowingSequence]:
    """Look at some values of the parameter for an unstable average, or a growing period."""
    system = family.system
    if len(system.switching.fixed_ends) < 2 or system.switching.resets:
        return "not tried: that takes two modes at each value, and no resets"
    if (count := _count(system)) is None:
        return ENCLOSED
    # Searches for periods could use the whole budget.
    allowance = family.allowance.part(0.5)
    for shares in product(SHARES, repeat=count) if count < 3 else ((s,) * count for s in SHARES):
        family_at_values = Family.of(system_at(system, shares), allowance)
        if (
            family_at_values.system.time is Time.CONTINUOUS
            and family_at_values.system.switching.is_arbitrary
        ):
            yield from _tag_shares(shares, search_mixture(family_at_values))
        yield from _tag_shares(shares, search_period(family_at_values))
    return "nothing grows at the values tried"


def _count(system: SwitchedSystem) -> int | None:
    """Return the number of constant parameters; None if their corners are enclosures."""
    count = len(system.switching.fixed_ends[0]).bit_length() - 1
    odd = find_odd_shares(system.switching, (Fraction(0),) * count)
    return count if odd is None else None


def _tag_shares(
    shares: Shares, candidates: Candidates[GrowingSequence]
) -> Iterator[Candidate[GrowingSequence]]:
    """Make what is found about the system at a value evidence about the parameters."""
    for candidate in candidates:
        yield Candidate(replace(candidate.evidence, shares=shares))


def _growth(corners: Array, shares: Array, time: Time) -> Array:
    """Return how far beyond the stability limit the worst eigenvalue is.

    Of a mode at the corners, shape (c, n, n), for values of the parameters, shape (m, k).
    """
    weights = np.ones((len(shares), 1))
    for share in shares.T:
        weight_pair = np.stack([1 - share, share], axis=1)
        weights = (weights[:, :, None] * weight_pair[:, None, :]).reshape(len(shares), -1)
    values = np.linalg.eigvals(np.tensordot(weights, corners, axes=1))
    if time is Time.CONTINUOUS:
        return np.asarray(values.real.max(axis=1))
    return np.asarray(np.abs(values).max(axis=1) - 1)


def _peaks(corners: Array, grid: Array, count: int, time: Time) -> list[tuple[int, Array]]:
    """Return the largest local maxima of the growth: the set of modes, and the shares."""
    values = np.stack(np.meshgrid(*[grid] * count, indexing="ij"), axis=-1)
    growth = np.array([_growth(c, values.reshape(-1, count), time) for c in corners])
    growth = growth.reshape(-1, *values.shape[:-1])
    highest = np.ones(growth.shape, dtype=bool)
    for axis in range(1, count + 1):
        padding = [(0, 0)] * growth.ndim
        padding[axis] = (1, 1)
        padded = np.moveaxis(np.pad(growth, padding, constant_values=-np.inf), axis, 0)
        here = np.moveaxis(highest, axis, 0)
        here &= (padded[1:-1] >= padded[:-2]) & (padded[1:-1] >= padded[2:])
    places = np.argwhere(highest)
    largest = np.argsort(-growth[highest], kind="stable")[:PEAKS]
    return [(int(places[i][0]), grid[places[i][1:]]) for i in largest]


def _refined(corners: Array, start: Array, step: float, time: Time) -> tuple[Array, float]:
    """Climb to a maximum near shares, no farther than a step; return it with its growth."""
    from scipy.optimize import Bounds, minimize

    def decline(shares: Array) -> float:
        return -float(_growth(corners, shares[None], time)[0])

    found = minimize(
        decline,
        start,
        method="Nelder-Mead",
        bounds=Bounds(np.maximum(start - step, 0.0), np.minimum(start + step, 1.0)),
        options={"maxiter": CLOSELY * len(start), "xatol": 1e-12, "fatol": 1e-15},
    )
    return np.asarray(found.x), -float(found.fun)


def search_mixture(family: Family) -> Candidates[GrowingSequence]:
    """Scan pairs of modes and random mixtures for a spectral abscissa that is not negative.

    When the work is used up, the search ends with what it has seen.
    """
    system, matrices = family.system, family.matrices
    weights, abscissa = _least_stable(matrices, family.allowance)
    if abscissa < -SLACK * np.abs(matrices).max():
        return "every combination tried is stable"
    for denominator in AVERAGE_DENOMINATORS:
        shares = _rationalize(weights, denominator)
        named_shares = tuple(
            (mode.name, share)
            for mode, share in zip(system.modes, shares, strict=True)
            if share > 0
        )
        yield Candidate(GrowingSequence(named_shares))
    return None


def _least_stable(matrices: Array, allowance: Allowance) -> tuple[Array, float]:
    """Return the weights of the average with the largest spectral abscissa, and that abscissa."""
    m, n = matrices.shape[:2]
    per_average = PER_MATRIX + PER_PRODUCT * (n**3 + m * n**2)
    found, largest = np.ones(m) / m, -np.inf
    for weights in weights_tried(m, max(1, CHUNK_ENTRIES // max(n * n, m))):
        averages = np.tensordot(weights, matrices, axes=1)
        abscissas = np.linalg.eigvals(averages).real.max(axis=1)
        best = int(abscissas.argmax())
        if abscissas[best] > largest:
            found, largest = weights[best], float(abscissas[best])
        if not allowance.goes_on(len(weights) * per_average):
            break
    return found, largest


def weights_tried(m: int, chunk: int) -> Iterator[Array]:
    """Yield rows of weights: pairs of modes at evenly spaced shares, then random ones."""
    if m == 1:
        yield np.ones((1, 1))
        return
    grid = list(product(islice(combinations(range(m), 2), MAX_PAIRS), range(1, PAIR_SHARES)))
    for start in range(0, len(grid), chunk):
        part = grid[start : start + chunk]
        weights, rows = np.zeros((len(part), m)), np.arange(len(part))
        shares = np.array([share for _, share in part]) / PAIR_SHARES
        weights[rows, [i for (i, _), _ in part]] = shares
        weights[rows, [j for (_, j), _ in part]] = 1 - shares
        yield weights
    rng = np.random.default_rng(0)
    for start in range(0, RANDOM_MIXTURES if m > 2 else 0, chunk):
        yield rng.dirichlet(np.full(m, 0.5), min(chunk, RANDOM_MIXTURES - start))


def _rationalize(weights: Array, denominator: int) -> list[Fraction]:
    """Round weights to a common denominator, keeping their sum at one."""
    counts = np.floor(weights * denominator + 0.5).astype(int)
    counts[counts.argmax()] += denominator - counts.sum()
    return [Fraction(int(count), denominator) for count in counts]
