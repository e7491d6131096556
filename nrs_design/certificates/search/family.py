"""The modes in floating point: what every search works on."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from nrs_design.certificates.checker import Checker
from nrs_design.certificates.search.allowance import Allowance
from nrs_design.certificates.search.balance import balance, scale
from nrs_design.certificates.search.decay import limit_rate
from nrs_design.switched.matrix import RationalMatrix
from nrs_design.switched.system import SwitchedSystem, Time


@dataclass(frozen=True)
class Family:
    """The modes in floating point, scaled by powers of two.

    Parameters
    ----------
    checker : Checker
        Of evidence for the exact modes.
    matrices : ndarray, shape (m, n, n)
        ``2^-d A 2^d``.
    exponents : ndarray of int, shape (n,)
        The d.
    limit : float
        Rate of the slowest mode that need never be left; without one, a rate out of reach.
    allowance : Allowance
        Time and memory for the searches; unlimited by default.
    """

    checker: Checker
    matrices: NDArray[np.float64]
    exponents: NDArray[np.int64]
    limit: float
    allowance: Allowance = field(default_factory=Allowance)

    @property
    def system(self) -> SwitchedSystem:
        """The exact modes."""
        return self.checker.system

    @classmethod
    def of(cls, system: SwitchedSystem) -> Family:
        """Convert and balance the modes of a system; modes of unequal size only give the limit."""
        return cls.checked_by(Checker(system))

    @classmethod
    def checked_by(cls, checker: Checker, allowance: Allowance | None = None) -> Family:
        """Convert and balance the modes that a checker speaks about."""
        allowance = allowance or Allowance()
        system = checker.system
        if not system.is_uniform:
            limit = _limit(system, [to_floats([mode.A]) for mode in system.modes])
            return cls(checker, np.zeros((0, 0, 0)), np.zeros(0, dtype=np.int64), limit, allowance)
        matrices = to_floats([mode.A for mode in system.modes])
        limit = _limit(system, [matrices])
        exponents = balance(matrices)
        scaled = scale(matrices, exponents)
        if not np.isfinite(scaled).all():
            scaled, exponents = matrices, np.zeros_like(exponents)
        return cls(checker, scaled, exponents, limit, allowance)


def _limit(system: SwitchedSystem, families: list[NDArray[np.float64]]) -> float:
    lasting = {mode.name for mode in system.lasting_modes()}
    if len(lasting) < len(system.modes):
        names = [mode.name for mode in system.modes]
        matrices = dict(zip(names, chain.from_iterable(families), strict=True))
        families = [matrices[name][None] for name in names if name in lasting]
        if not families:
            sizes = [np.abs(np.linalg.eigvals(A)).max() for A in matrices.values()]
            return float(max(sizes)) if system.time is Time.CONTINUOUS else 0.0
    limits = [limit_rate(matrices, system.time) for matrices in families]
    return min(limits) if system.time is Time.CONTINUOUS else max(limits)


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
    """Let floating point over- and underflow without a word: it only chooses what to try."""
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore", RuntimeWarning)
        yield
