"""Search for an unstable mode: floating-point eigenvalues order the exact tests."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.evidence import GrowingSequence
from nrs_design.proof.evidence.growing_sequence import decides, staying
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.spectrum import affordable, is_stable
from nrs_design.search.acceptance import Candidate, Candidates
from nrs_design.search.balance import scale_states
from nrs_design.search.family import Family, to_floats
from nrs_design.search.work import Cost

# Modes nearer to the stability limit than this, relative to their norm, get an exact test first.
SUSPICION = 1e-7
# Exact tests of a mode that are predicted to take no more work are always made.
ALWAYS_TESTED = 0.05


def examine_suspicious_modes(family: Family) -> Candidates[GrowingSequence]:
    """Test exactly the modes that floating-point eigenvalues do not show to be stable."""
    return (yield from unstable_modes(_suspicious(family), family))


def examine_every_mode(family: Family) -> Candidates[GrowingSequence]:
    """Test exactly every mode that need never be left, and free motion without the deflection."""
    system, lasting = family.system, family.system.lasting_modes()
    outcome = yield from unstable_modes((*system.free_motions(), *lasting), family)
    if outcome and (left := len(system.modes) - len(lasting)):
        outcome += f"; {left} not tested, they must be left and may be unstable"
    return outcome


def _suspicious(family: Family) -> list[Mode]:
    """Return the modes that may last and do not seem stable: what refutes, then free motion first.

    What is unstable in the air is so whatever is touched, and no proof covers it.
    """
    system, free = family.system, family.system.free_motions()
    flying = frozenset(() if system.flights is None else system.flights.flying)
    lasting = {mode.name for mode in system.lasting_modes()}
    pairs = zip(system.modes, seems_stable(family), strict=True)
    modes = [mode for mode, ok in pairs if not ok and mode.name in lasting]
    modes.sort(key=lambda mode: (not decides(system, mode.name), mode.name not in flying))
    if not free:
        return modes
    scaled = scale_states(to_floats([mode.A for mode in free]), family.exponents[:-1])
    pairs = zip(free, _clearly_stable(scaled, system.time), strict=True)
    return [*(mode for mode, ok in pairs if not ok), *modes]


def unstable_modes(modes: Iterable[Mode], family: Family) -> Candidates[GrowingSequence]:
    """Decide exactly, mode by mode; in the end say how many are stable, if all are."""
    time, count, skipped, found = family.system.time, 0, 0, False
    for mode, fits in affordable(modes):
        if not fits:
            skipped += 1
            continue
        count += 1
        cost = exact_test_cost(mode.A)
        if cost.work > ALWAYS_TESTED:
            family.allowance.take(cost, f"the exact test of mode {mode.name}")
        if not is_stable(mode.A, time):
            yield Candidate(staying(mode.name), f"mode {mode.name} is not stable")
            found = True
    if found:
        return None
    tested = f"{count} modes tested exactly, all stable" if count else "none"
    return tested + (f"; {skipped} not tried, their numbers are too large" * (skipped > 0))


def find_unstable_corner(family: Family) -> str | None:
    """Return the name of an unstable corner of an enclosure, or None."""
    system = family.system
    corners = {name for names in system.enclosures for name in names}
    suspicious = (mode for mode in _suspicious(family) if mode.name in corners)
    for mode, fits in affordable(suspicious):
        if fits and decides(system, mode.name) and not is_stable(mode.A, system.time):
            return mode.name
    return None


def exact_test_cost(A: RationalMatrix) -> Cost:
    """Predict what the exact test of one mode takes."""
    n = A.shape[0]
    bits = max(entry.bit_length() for row in (*A.numerators, (A.denominator,)) for entry in row)
    grown = n * (bits + n.bit_length())
    return Cost(n**4 * (1e-7 + 2e-13 * grown**2))


def seems_stable(family: Family) -> NDArray[np.bool_]:
    """Tell in floating point which modes are clearly stable; shape (m,)."""
    size = np.abs(family.matrices).max()
    continuous = family.system.time is Time.CONTINUOUS
    slow = SUSPICION * size < family.limit if continuous else family.limit < 1 - SUSPICION
    if slow and np.isfinite(size):
        return np.ones(len(family.matrices), dtype=bool)
    return _clearly_stable(family.matrices, family.system.time)


def _clearly_stable(matrices: NDArray[np.float64], time: Time) -> NDArray[np.bool_]:
    if not np.isfinite(matrices).all():
        return np.zeros(len(matrices), dtype=bool)
    eigenvalues = np.linalg.eigvals(matrices)
    if time is Time.CONTINUOUS:
        size = np.abs(matrices).max(axis=(1, 2))
        return np.asarray(eigenvalues.real.max(axis=1) < -SUSPICION * size)
    return np.asarray(np.abs(eigenvalues).max(axis=1) < 1 - SUSPICION)
