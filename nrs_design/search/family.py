"""The modes in floating point: what every search works on."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.balance import balance, mean_norm, scale_states, separating
from nrs_design.search.work import Allowance

# Modes that differ by less, relative to their largest entries, are nearly the same.
NEARLY = 1e-12
Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Family:
    """The modes in floating point, scaled by powers of two."""

    system: SwitchedSystem  # The exact modes
    matrices: NDArray[np.float64]  # Shape (m, n, n). ``2^-d A 2^d``.
    exponents: NDArray[np.int64]  # Shape (n,). The d.
    # Rate of the slowest mode that need never be left; without one, a rate out of reach.
    limit: float
    # Work and memory for the searches; unlimited by default.
    allowance: Allowance = field(default_factory=Allowance)
    optimize_rate: bool = True  # Look for the largest provable decay rate, not only for some

    def stand_ins(self) -> dict[str, str]:
        """Return for each mode the first that is nearly the same; nothing where rules matter.

        The two ends of an enclosed number make modes that differ by its last digits. In discrete
        time only: without rules, modes of continuous time need no functions of their own.
        """
        system, matrices = self.system, self.matrices
        if not system.switching.is_arbitrary or system.time is Time.CONTINUOUS:
            return {}
        return stand_ins([mode.name for mode in system.modes], matrices)

    @classmethod
    def of(
        cls,
        system: SwitchedSystem,
        allowance: Allowance | None = None,
        *,
        optimize_rate: bool = True,
    ) -> Family:
        """Convert and balance the modes of a system; modes of unequal size only give the limit."""
        allowance, lasting = allowance or Allowance(), system.lasting_modes()
        limit = _slowest(lasting, system.time) if lasting else 0.0
        if not lasting and system.time is Time.CONTINUOUS:
            limit = _slowest(system.modes, Time.DISCRETE)
        if not system.is_uniform:
            no_matrices = np.zeros((0, 0, 0)), np.zeros(0, dtype=np.int64)
            return cls(system, *no_matrices, limit, allowance, optimize_rate)
        matrices = to_floats([mode.A for mode in system.modes])
        exponents = balance(matrices)
        scaled = scale_states(matrices, exponents)
        if not np.isfinite(scaled).all():
            scaled, exponents = matrices, np.zeros_like(exponents)
        return cls(system, scaled, exponents, limit, allowance, optimize_rate)


def rate_limit(system: SwitchedSystem) -> float | None:
    """Return an upper bound of provable rates: the rate of the slowest mode that may last forever.

    In 1/s, or per step; None if all modes must be left, or floating point does not hold them.
    """
    lasting = system.lasting_modes()
    limit = _slowest(lasting, system.time) if lasting else np.nan
    return limit if np.isfinite(limit) else None


def _slowest(modes: Sequence[Mode], time: Time) -> float:
    """Return the rate of the slowest mode of any sizes, as `limit_rate` does."""
    ordered = sorted((mode.A for mode in modes), key=lambda A: A.shape[0])
    alike = (to_floats([*group]) for _, group in groupby(ordered, lambda A: A.shape[0]))
    limits = np.array([limit_rate(matrices, time) for matrices in alike])
    return float(limits.min() if time is Time.CONTINUOUS else limits.max())


def limit_rate(matrices: NDArray[np.float64], time: Time) -> float:
    """Return the rate of the slowest mode: ``-max Re`` in 1/s, or the largest spectral radius.

    Not a number if the matrices are beyond the range of floating point.
    """
    if not np.isfinite(matrices).all():
        return np.nan
    eigenvalues = np.linalg.eigvals(matrices)
    if time is Time.CONTINUOUS:
        return float(-eigenvalues.real.max())
    return float(np.abs(eigenvalues).max())


def nearly_same(stack: NDArray[np.float64]) -> list[int]:
    """Return for each entry of a stack the number of the first that floats hardly tell from it."""
    representatives: list[int] = []
    found: list[int] = []
    for i, one in enumerate(stack):
        tolerance = NEARLY * np.abs(one).max()
        k = next((k for k in representatives if np.abs(stack[k] - one).max() <= tolerance), i)
        if k == i:
            representatives.append(i)
        found.append(k)
    return found


def stand_ins(names: Sequence[str], matrices: NDArray[np.float64]) -> dict[str, str]:
    """Return for each name the first one with nearly the same matrix."""
    return {name: names[k] for name, k in zip(names, nearly_same(matrices), strict=True)}


def distinct_modes(modes: Sequence[Mode]) -> list[tuple[Mode, NDArray[np.float64]]]:
    """Return modes in floating point, without those that differ by an enclosed number."""
    matrices = to_floats([mode.A for mode in modes])
    return [(modes[k], matrices[k]) for k in dict.fromkeys(nearly_same(matrices))]


def to_floats(matrices: Sequence[RationalMatrix]) -> NDArray[np.float64]:
    """Convert matrices of one size, in one go where the integers allow; shape (m, n, n).

    A search needs no correct rounding.
    """
    try:
        numerators = np.array([A.numerators for A in matrices], dtype=np.int64)
        denominators = np.array([A.denominator for A in matrices], dtype=np.float64)
    except OverflowError:
        return np.array([A.floats() for A in matrices])
    return np.asarray(numerators / denominators[:, None, None])


@contextmanager
def floats_in_silence() -> Iterator[None]:
    """Silence over- and underflow: floating point only proposes."""
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore", RuntimeWarning)
        yield


def free_motions(family: Family) -> Array:
    """Return the free modes in the coordinates of a family, shape (f, n, n)."""
    d = family.exponents
    free = to_floats([mode.A for mode in family.system.free]).reshape(-1, len(d), len(d))
    return scale_states(free, d)


def separating_coordinates(family: Family) -> Array:
    """Return T that makes the mean of the modes' norms round, but leaves the deflection alone."""
    return separating(mean_norm(family.matrices, family.system.time))
