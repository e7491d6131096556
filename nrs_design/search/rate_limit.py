"""The other side of a decay rate: what no proof can exceed (floating point, for the reader)."""

from __future__ import annotations

from math import isfinite

import numpy as np

from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.decay import limit_rate
from nrs_design.search.family import to_floats
from nrs_design.search.words import products_of

MAX_WORDS = 3000
# Multiplications in the eigenvalues of all words of a length.
MAX_WORK = 30_000_000


def rate_limit(system: SwitchedSystem) -> float | None:
    """Return a rate that solutions cannot beat, because one of them attains it.

    Modes that must be left are left out of account; None if all are, or if modes take turns.
    Continuous time: the slowest mode's ``-max Re``, in 1/s. Discrete time: the largest
    ``radius(A_k ... A_1)^(1/k)`` over short products of modes, a lower bound of the joint spectral
    radius; where switching is constrained, of single modes only. That of the slowest case.
    """
    if system.cases:
        every = [rate_limit(system.only(frozenset(names))) for names in system.cases]
        known = [limit for limit in every if limit is not None]
        slowest = min if system.time is Time.CONTINUOUS else max
        return slowest(known) if len(known) == len(every) else None
    modes = system.lasting_modes()
    if not modes:
        return None
    if system.is_uniform:
        families = [to_floats([mode.A for mode in modes])]
    else:
        families = [to_floats([mode.A]) for mode in modes]
    limits = [limit_rate(matrices, system.time) for matrices in families]
    if not all(map(isfinite, limits)):
        return None
    if system.time is Time.CONTINUOUS:
        return min(limits)
    if system.switching.is_arbitrary:
        limits.append(_cycle_growth(families[0]))
    limit = max(limits)
    return limit if isfinite(limit) else None


def _cycle_growth(matrices: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> float:
    m, length, best = len(matrices), 1, 0.0
    words_at_most = min(MAX_WORDS, MAX_WORK // len(matrices[0]) ** 3)
    while m > 1 and m ** (length + 1) <= words_at_most:
        length += 1
        _, found = products_of(matrices, length)
        if not np.isfinite(found).all():
            break
        radius = np.abs(np.linalg.eigvals(found)).max()
        best = max(best, float(radius) ** (1 / length))
    return best
