"""The steps of a certification: each looks for evidence and says in words how it ended.

Floating point only chooses what to try. What a step returns has passed the exact check.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nrs_design.certificates.balance import balance, scale
from nrs_design.certificates.certificate import CommonQuadratic, Evidence
from nrs_design.certificates.decay import largest_position, limit_rate, rate_at, rate_of
from nrs_design.certificates.gradient import iterate_gradient
from nrs_design.certificates.lmi import find_common_quadratic
from nrs_design.certificates.rounding import round_rate, round_to_evidence
from nrs_design.certificates.second_opinion import unstable_mode
from nrs_design.switched.system import Mode, SwitchedSystem, Time

# How far below the best rate found the claimed one may lie: a wider gap needs fewer digits.
BACK_OFFS = (0.9995, 0.998, 0.99, 0.9, 0.5, 0.1, 1e-3)
# Modes nearer to the stability limit than this, relative to their norm, get an exact test first.
SUSPICION = 1e-7
OUT_OF_RANGE = "the modes are beyond the range of floating point"

Finding = tuple[Evidence | None, str]
Step = Callable[["Family"], Finding]


@dataclass(frozen=True)
class Family:
    """The modes in floating point, scaled by powers of two.

    Parameters
    ----------
    system : SwitchedSystem
        The exact modes.
    matrices : ndarray, shape (m, n, n)
        ``2^-d A 2^d``.
    exponents : ndarray of int, shape (n,)
        The d.
    limit : float
        Rate of the slowest mode.
    """

    system: SwitchedSystem
    matrices: NDArray[np.float64]
    exponents: NDArray[np.int64]
    limit: float

    @classmethod
    def of(cls, system: SwitchedSystem) -> Family:
        """Convert and balance the modes of a system."""
        matrices = np.array([mode.A.floats() for mode in system.modes])
        exponents = balance(matrices)
        scaled = scale(matrices, exponents)
        if not np.isfinite(scaled).all():
            scaled, exponents = matrices, np.zeros_like(exponents)
        return cls(system, scaled, exponents, limit_rate(scaled, system.time))


@contextmanager
def floats_in_silence() -> Iterator[None]:
    """Let floating point over- and underflow without a word: it only chooses what to try."""
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore", RuntimeWarning)
        yield


def examine_suspicious_modes(family: Family) -> Finding:
    """Test exactly the modes that floating-point eigenvalues do not show to be stable."""
    suspicious = [
        mode for mode, ok in zip(family.system.modes, _seems_stable(family), strict=True) if not ok
    ]
    return _first_unstable(suspicious, family.system.time)


def examine_every_mode(family: Family) -> Finding:
    """Test every mode exactly."""
    return _first_unstable(family.system.modes, family.system.time)


def search_by_lmi(family: Family, *, optimize_rate: bool) -> Finding:
    """Search by semidefinite programming; then, if asked to, raise the rate."""
    time = family.system.time
    if not np.isfinite(family.limit):
        return None, OUT_OF_RANGE
    Q = find_common_quadratic(family.matrices, time, rate_at(0.0, family.limit, time))
    if Q is None:
        return None, "the solver found no candidate with positive margins"
    if optimize_rate:
        best = largest_position(family.matrices, time, family.limit)
        for back_off in BACK_OFFS:
            rate = rate_at(best * back_off, family.limit, time)
            candidate = find_common_quadratic(family.matrices, time, rate)
            if candidate is not None and (evidence := _round(family, candidate, rate)):
                return evidence, "found with the largest decay rate"
    return _round_at_own_rate(family, Q)


def search_by_gradient(family: Family) -> Finding:
    """Search by the Liberzon-Tempo iteration."""
    if not np.isfinite(family.limit):
        return None, OUT_OF_RANGE
    result = iterate_gradient(family.matrices)
    if result.Q is None:
        return None, f"not converged after {result.updates} updates"
    evidence, outcome = _round_at_own_rate(family, result.Q)
    return evidence, f"{outcome} after {result.updates} updates"


def _round_at_own_rate(family: Family, Q: NDArray[np.float64]) -> Finding:
    """Round a candidate at a rate just below the one that it shows itself."""
    rate = rate_of(family.matrices, Q, family.system.time)
    for back_off in BACK_OFFS:
        slower = rate_at(back_off, rate, family.system.time)
        if evidence := _round(family, Q, slower):
            return evidence, "found"
    return None, "a candidate was found, but no rounding of it passes the exact check"


def _round(family: Family, Q: NDArray[np.float64], rate: float) -> CommonQuadratic | None:
    if not np.isfinite(rate):
        return None
    claimed = round_rate(rate, family.system.time)
    if claimed <= 0 or (family.system.time is Time.DISCRETE and claimed >= 1):
        return None
    return round_to_evidence(family.system, Q, family.exponents, claimed)


def _seems_stable(family: Family) -> NDArray[np.bool_]:
    if not np.isfinite(family.matrices).all():
        return np.zeros(len(family.matrices), dtype=bool)
    eigenvalues = np.linalg.eigvals(family.matrices)
    size = np.abs(family.matrices).max(axis=(1, 2))
    if family.system.time is Time.CONTINUOUS:
        return np.asarray(eigenvalues.real.max(axis=1) < -SUSPICION * size)
    return np.asarray(np.abs(eigenvalues).max(axis=1) < 1 - SUSPICION)


def _first_unstable(modes: Iterable[Mode], time: Time) -> Finding:
    count = 0
    for mode in modes:
        count += 1
        if evidence := unstable_mode(mode, time):
            return evidence, f"mode {mode.name} is not stable"
    return None, f"{count} modes tested exactly, all stable" if count else "none"
