"""Search for a convex combination of modes that is not Hurwitz."""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from nrs_design.certificates.evidence import UnstableMixture
from nrs_design.certificates.evidence.unstable_mixture import mixture
from nrs_design.certificates.evidence.unstable_mode import worst_eigenvalue
from nrs_design.switched.system import SwitchedSystem

Array = NDArray[np.float64]

SHARES = 128
MAX_PAIRS = 300
RANDOM_MIXTURES = 2000
DENOMINATORS = (16, 64, 1024, 2**20)


def find_unstable_mixture(system: SwitchedSystem, matrices: Array) -> UnstableMixture | None:
    """Scan pairs of modes and random mixtures for a spectral abscissa that is not negative.

    Parameters
    ----------
    system : SwitchedSystem
        Exact modes, continuous time.
    matrices : ndarray, shape (m, n, n)
        The same in floating point.
    """
    weights = _candidates(len(matrices))
    averages = np.tensordot(weights, matrices, axes=1)
    abscissas = np.linalg.eigvals(averages).real.max(axis=1)
    best = int(abscissas.argmax())
    if abscissas[best] < -1e-9 * np.abs(matrices).max():
        return None
    for denominator in DENOMINATORS:
        shares = _rationalize(weights[best], denominator)
        named = tuple(
            (mode.name, share)
            for mode, share in zip(system.modes, shares, strict=True)
            if share > 0
        )
        evidence = UnstableMixture(named, worst_eigenvalue(mixture(system, named), system.time))
        if evidence.find_fault(system) is None:
            return evidence
    return None


def _candidates(m: int) -> Array:
    """Return rows of weights: pairs of modes at evenly spaced shares, then random ones."""
    rng = np.random.default_rng(0)
    pairs = list(combinations(range(m), 2))[:MAX_PAIRS]
    shares = np.arange(1, SHARES) / SHARES
    weights = np.zeros((len(pairs) * len(shares), m))
    for k, (i, j) in enumerate(pairs):
        rows = slice(k * len(shares), (k + 1) * len(shares))
        weights[rows, i], weights[rows, j] = shares, 1 - shares
    if m <= 2:
        return weights if m == 2 else np.ones((1, 1))
    return np.vstack([weights, rng.dirichlet(np.full(m, 0.5), RANDOM_MIXTURES)])


def _rationalize(weights: Array, denominator: int) -> list[Fraction]:
    """Round weights to a common denominator, keeping their sum at one."""
    counts = np.floor(weights * denominator + 0.5).astype(int)
    counts[counts.argmax()] += denominator - counts.sum()
    return [Fraction(int(count), denominator) for count in counts]
