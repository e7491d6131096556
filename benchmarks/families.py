"""Random families of modes with a known common quadratic function, seeded."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.system import SwitchedSystem

Matrices = NDArray[np.float64]


def stable_family(n: int, m: int, seed: int) -> Matrices:
    """Return m modes, shape (m, n, n), that share a random Q, in three decimals.

    ``A = Q^-1 (K - S/2)`` with K skew and S positive definite gives ``A'Q + QA = -S``.
    """
    rng = np.random.default_rng(seed)
    R = rng.normal(size=(n, n))
    Q = R @ R.T / n + 0.3 * np.eye(n)
    S = _gram(rng, m, n, n) + 0.3 * np.eye(n)
    return np.asarray(np.round(np.linalg.solve(Q, _skew(rng, m, n) - S / 2), 3))


def hurwitz_family(rng: np.random.Generator, n: int, m: int) -> Matrices:
    """Return m random modes with stability margins from 0.05 to 2, in four decimals."""
    A = rng.normal(size=(m, n, n))
    slowest = np.linalg.eigvals(A).real.max(axis=1)
    shift = slowest + rng.uniform(0.05, 2.0, size=m)
    return np.asarray(np.round(A - shift[:, None, None] * np.eye(n), 4))


def dayawansa_martin(a: Fraction) -> SwitchedSystem:
    """Return the pair of Dayawansa and Martin (1999): quadratic iff a < 3 + 2 sqrt(2)."""
    one = RationalMatrix(((-1, -1), (1, -1)))
    other = RationalMatrix.from_rows([[Fraction(-1), -a], [1 / a, Fraction(-1)]])
    modes = (Mode("one", one), Mode("other", other))
    return SwitchedSystem(
        name="dayawansa-martin",
        time=Time.CONTINUOUS,
        states=("x1", "x2"),
        modes=modes,
        assumptions=(),
    )


def to_system(matrices: Matrices, decimals: int) -> SwitchedSystem:
    """Return the exact switched system of matrices with so many decimals."""
    scale = 10**decimals
    modes = tuple(
        Mode(f"m{i}", RationalMatrix(tuple(tuple(int(a) for a in row) for row in A), scale))
        for i, A in enumerate(np.rint(matrices * scale))
    )
    states = tuple(f"x{i + 1}" for i in range(matrices.shape[1]))
    return SwitchedSystem(
        name="family", time=Time.CONTINUOUS, states=states, modes=modes, assumptions=()
    )


def _gram(rng: np.random.Generator, m: int, n: int, rank: int) -> Matrices:
    R = rng.normal(size=(m, n, rank))
    return np.asarray(R @ R.transpose(0, 2, 1) / n, dtype=np.float64)


def _skew(rng: np.random.Generator, m: int, n: int) -> Matrices:
    K = rng.normal(size=(m, n, n))
    return np.asarray((K - K.transpose(0, 2, 1)) / np.sqrt(n), dtype=np.float64)
