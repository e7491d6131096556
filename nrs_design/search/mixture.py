"""Search for a convex combination of modes that is not Hurwitz."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import combinations, islice, product

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.evidence import GrowingSequence
from nrs_design.search.candidates import Candidate, Candidates
from nrs_design.search.family import Family
from nrs_design.work import Allowance

Array = NDArray[np.float64]

SHARES = 128
MAX_PAIRS = 300
RANDOM_MIXTURES = 2000
# Work for the eigenvalues of an average, and per multiplication in making it and in them.
PER_MATRIX = 5e-6
PER_PRODUCT = 3e-8
# Entries of the averages that are looked at together.
CHUNK_ENTRIES = 2_000_000
DENOMINATORS = (16, 64, 1024, 2**20)
# What rounding hides, relative to the size of the matrices.
SLACK = 1e-9


def search_mixture(family: Family) -> Candidates[GrowingSequence]:
    """Scan pairs of modes and random mixtures for a spectral abscissa that is not negative.

    When the work is used up, the search ends with what it has seen.
    """
    system, matrices = family.system, family.matrices
    weights, abscissa = _least_stable(matrices, family.allowance)
    if abscissa < -SLACK * np.abs(matrices).max():
        return "every combination tried is stable"
    for denominator in DENOMINATORS:
        shares = _rationalize(weights, denominator)
        named = tuple(
            (mode.name, share)
            for mode, share in zip(system.modes, shares, strict=True)
            if share > 0
        )
        yield Candidate(GrowingSequence(named))
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
    grid = list(product(islice(combinations(range(m), 2), MAX_PAIRS), range(1, SHARES)))
    for start in range(0, len(grid), chunk):
        part = grid[start : start + chunk]
        weights, rows = np.zeros((len(part), m)), np.arange(len(part))
        shares = np.array([share for _, share in part]) / SHARES
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
