"""The rungs of the ladder: each looks for evidence and says in words how it ended.

Floating point only chooses what to try. What a rung returns has passed the exact check.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.evidence import AbstractEvidence, CommonQuadratic, UnstableMode
from nrs_design.proof.evidence.unstable_mode import (
    affordable,
    is_stable,
    worst_eigenvalue,
)
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.system import Mode, Time
from nrs_design.search.allowance import Cost, NotAffordableError
from nrs_design.search.balance import mean_norm, mean_norm_coordinates, scale
from nrs_design.search.decay import largest_position, rate_at, rate_of
from nrs_design.search.family import Family
from nrs_design.search.gradient import iterate_gradient
from nrs_design.search.lmi import find_common_quadratic, margins, solve_by_clarabel
from nrs_design.search.mixture import find_unstable_mixture
from nrs_design.search.mode_quadratic import find_mode_functions
from nrs_design.search.obstruction import round_obstruction, solve_dual
from nrs_design.search.parameter_quadratic import find_parameter_quadratic
from nrs_design.search.period import find_growing_period
from nrs_design.search.polynomial import (
    Candidate,
    Lift,
    find_common_polynomial,
    lift_family,
    polynomial_cost,
    round_polynomial,
)
from nrs_design.search.raw import find_raw_quadratic
from nrs_design.search.rounding import round_rate, round_to_evidence
from nrs_design.search.unstable_value import (
    find_unstable_switching,
    find_unstable_value,
)

# How far below the best rate found the claimed one may lie: a wider gap needs fewer digits.
BACK_OFFS = (0.9995, 0.998, 0.99, 0.9, 0.5, 0.1, 1e-3)
BACK_OFF = Fraction(1999, 2000)
# Modes nearer to the stability limit than this, relative to their norm, get an exact test first.
SUSPICION = 1e-7
# Exact tests of a mode that are predicted to take no more seconds are always made.
ALWAYS_TESTED = 0.05
OUT_OF_RANGE = "the modes are beyond the range of floating point"

RATE_BISECTIONS = 8
POLYNOMIAL_BACK_OFF = 0.98

Finding = tuple[AbstractEvidence | None, str]
Rung = Callable[[Family], Finding]


def examine_suspicious_modes(family: Family) -> Finding:
    """Test exactly the modes that floating-point eigenvalues do not show to be stable."""
    lasting = {mode.name for mode in family.system.lasting_modes()}
    suspicious = [
        mode
        for mode, ok in zip(family.system.modes, _seems_stable(family), strict=True)
        if not ok and mode.name in lasting
    ]
    return _first_unstable(suspicious, family)


def examine_every_mode(family: Family) -> Finding:
    """Test exactly every mode that need never be left."""
    lasting = family.system.lasting_modes()
    evidence, outcome = _first_unstable(lasting, family)
    if left := len(family.system.modes) - len(lasting):
        outcome += f"; {left} not tested, they must be left and may be unstable"
    return evidence, outcome


def search_by_lmi(family: Family, *, optimize_rate: bool) -> Finding:
    """Search by semidefinite programming; then, if asked to, raise the rate."""
    time, allowance = family.system.time, family.allowance
    if not np.isfinite(family.limit):
        return None, OUT_OF_RANGE
    least = rate_at(0.0, family.limit, time)
    try:
        Q = find_common_quadratic(family.matrices, time, least, allowance=allowance)
    except NotAffordableError:
        Q = mean_norm(family.matrices, time)
        if margins(family.matrices, Q, time, least).min() <= 0:
            raise
        return _round_at_own_rate(family, Q)
    if Q is None:
        return None, "the solver found no candidate with positive margins"
    if optimize_rate and (evidence := _fastest(family)):
        return evidence, "found with the largest decay rate"
    return _round_at_own_rate(family, Q)


def _fastest(family: Family) -> CommonQuadratic | None:
    """Search for the largest rate in half of the time that is left, and round in the other half."""
    time, allowance = family.system.time, family.allowance
    best = largest_position(family.matrices, time, family.limit, allowance.part(0.5))
    try:
        for back_off in BACK_OFFS:
            rate = rate_at(best * back_off, family.limit, time)
            candidate = find_common_quadratic(family.matrices, time, rate, allowance=allowance)
            if candidate is not None and (evidence := _round(family, candidate, rate)):
                return evidence
    except NotAffordableError:
        pass
    return None


def decide_one_state(family: Family) -> Finding:
    """Take ``V(x) = x^2``, at a rate computed exactly: modes may be nearer to 1 than floats are."""
    system = family.system
    numbers = [mode.A.fractions()[0][0] for mode in system.modes]
    claimed = BACK_OFF * -max(numbers)
    if system.time is Time.DISCRETE:
        claimed = 1 - BACK_OFF * (1 - max(map(abs, numbers)))
    evidence = CommonQuadratic(((1,),), 0, round_rate(claimed, system.time))
    fault = family.checker.find_fault(evidence)
    return (evidence, "found") if fault is None else (None, fault)


def search_by_gradient(family: Family) -> Finding:
    """Search by the Liberzon-Tempo iteration."""
    if not np.isfinite(family.limit):
        return None, OUT_OF_RANGE
    # The rungs below need time as well.
    result = iterate_gradient(family.matrices, allowance=family.allowance.part(0.5))
    if result.Q is None:
        return None, f"not converged after {result.updates} updates"
    evidence, outcome = _round_at_own_rate(family, result.Q)
    return evidence, f"{outcome} after {result.updates} updates"


def search_raw(family: Family) -> Finding:
    """Search by CVXPY in the coordinates of the spec, without balancing."""
    time = family.system.time
    if not np.isfinite(family.limit):
        return None, OUT_OF_RANGE
    matrices = scale(family.matrices, -family.exponents)
    least = rate_at(0.0, family.limit, time)
    Q = find_raw_quadratic(matrices, time, least, family.allowance)
    if Q is None:
        return None, "the solver found no candidate with positive margins"
    shifts = family.exponents[:, None] + family.exponents[None, :]
    return _round_at_own_rate(family, np.ldexp(Q, shifts))


def search_preconditioned(family: Family) -> Finding:
    """Search by a general solver after a change to the mean of the modes' own norms."""
    time = family.system.time
    if not np.isfinite(family.limit):
        return None, OUT_OF_RANGE
    T = mean_norm_coordinates(family.matrices, time)
    inverse = np.linalg.inv(T)
    least = rate_at(0.0, family.limit, time)
    matrices = inverse @ family.matrices @ T
    Q = find_common_quadratic(matrices, time, least, solve_by_clarabel, family.allowance)
    if Q is None:
        return None, "the solver found no candidate with positive margins"
    return _round_at_own_rate(family, inverse.T @ Q @ inverse)


def prove_obstruction(family: Family) -> Finding:
    """Search for a proof that there is no common quadratic function."""
    multipliers = solve_dual(family.matrices, family.system.time, family.allowance)
    if multipliers is None:
        return None, "the dual has no strict solution"
    evidence = round_obstruction(family.system, multipliers, family.exponents)
    if evidence is None:
        return None, "a dual solution was found, but no rounding of it passes the exact check"
    return evidence, "no common quadratic function exists"


def search_polynomial(family: Family, *, degree: int, optimize_rate: bool = False) -> Finding:
    """Search for a common homogeneous polynomial of degree 2d, and a large rate if asked to.

    Parameters
    ----------
    family : Family
        The modes.
    degree : int
        The d of a form of degree 2d.
    optimize_rate : bool
        Look for a large rate.
    """
    system, allowance = family.system, family.allowance
    allowance.require(*polynomial_cost(system.order, len(system.modes), degree))
    lift = lift_family(system, family.exponents, degree)
    least = rate_at(0.0, family.limit, system.time)
    candidate = find_common_polynomial(lift, system.time, least, allowance)
    if candidate is None:
        return None, "the solver found no candidate with positive margins"
    evidence = round_polynomial(system, lift, candidate, family.limit)
    if evidence is None:
        return None, "a candidate was found, but no rounding of it passes the exact check"
    if optimize_rate and (faster := _faster_polynomial(family, lift)):
        return faster, "found with a decay rate near the largest"
    return evidence, "found"


def _faster_polynomial(family: Family, lift: Lift) -> AbstractEvidence | None:
    """Bisect for a larger rate, and take the function found a little below it."""
    time = family.system.time

    def find(position: float) -> Candidate | None:
        rate = rate_at(position, family.limit, time)
        return find_common_polynomial(lift, time, rate, family.allowance)

    low, high = 0.0, 1.0
    try:
        for _ in range(RATE_BISECTIONS):
            middle = (low + high) / 2
            low, high = (low, middle) if find(middle) is None else (middle, high)
        candidate = find(POLYNOMIAL_BACK_OFF * low) if low > 0 else None
    except NotAffordableError:
        return None
    if candidate is None:
        return None
    return round_polynomial(family.system, lift, candidate, family.limit)


def search_mode_quadratic(family: Family) -> Finding:
    """Search for one quadratic function per mode, for constrained switching."""
    evidence = find_mode_functions(family.system, family.limit, allowance=family.allowance)
    return evidence, "found" if evidence else "no candidate passes the exact check"


def search_mode_polynomial(family: Family, *, degree: int) -> Finding:
    """Search for one polynomial of degree 2d per mode, for constrained switching."""
    evidence = find_mode_functions(family.system, family.limit, degree, family.allowance)
    return evidence, "found" if evidence else "no candidate passes the exact check"


def search_parameter_quadratic(family: Family) -> Finding:
    """Search for a quadratic function that is affine in a constant parameter."""
    evidence = find_parameter_quadratic(
        family.system, family.matrices, family.exponents, family.limit, family.allowance
    )
    return evidence, "found" if evidence else "no candidate passes the exact check"


def search_value(family: Family) -> Finding:
    """Search for a value of a constant parameter at which a mode is not stable."""
    if not np.isfinite(family.matrices).all():
        return None, OUT_OF_RANGE
    evidence = find_unstable_value(family.system, family.matrices)
    return evidence, "found" if evidence else "every mode is stable at every value tried"


def search_switching_at_values(family: Family) -> Finding:
    """Search for an unstable average or a growing period at some values of the parameter."""
    evidence = find_unstable_switching(family.system)
    return evidence, "found" if evidence else "nothing grows at the values tried"


def search_mixture(family: Family) -> Finding:
    """Search for an unstable convex combination of modes."""
    evidence = find_unstable_mixture(family.system, family.matrices, family.allowance)
    return evidence, "found" if evidence else "every combination tried is stable"


def search_period(family: Family) -> Finding:
    """Search for a periodic signal that makes solutions grow."""
    evidence = find_growing_period(family.system, family.matrices, family.allowance)
    return evidence, "found" if evidence else "no periodic signal tried makes solutions grow"


def _round_at_own_rate(family: Family, Q: NDArray[np.float64]) -> Finding:
    """Round a candidate at a rate just below the one that it shows itself."""
    rate = rate_of(family.matrices, Q, family.system.time)
    for back_off in BACK_OFFS:
        slower = rate_at(back_off, rate, family.system.time)
        if evidence := _round(family, Q, slower):
            return evidence, "found"
    return None, "a candidate was found, but no rounding of it passes the exact check"


def _round(family: Family, Q: NDArray[np.float64], rate: float) -> CommonQuadratic | None:
    time = family.system.time
    if not np.isfinite(rate):
        return None
    claimed = round_rate(rate, time)
    if claimed <= 0 or (time is Time.DISCRETE and claimed >= 1):
        return None

    def passes(rounded: NDArray[np.float64]) -> bool:
        return bool(margins(family.matrices, rounded, time, float(claimed)).min() > 0)

    return round_to_evidence(family.checker, Q, family.exponents, claimed, passes)


def exact_test_cost(A: RationalMatrix) -> Cost:
    """Predict what the exact test of one mode takes."""
    n = A.shape[0]
    bits = max(entry.bit_length() for row in (*A.numerators, (A.denominator,)) for entry in row)
    grown = n * (bits + n.bit_length())
    return Cost(n**4 * (1e-7 + 2e-13 * grown**2))


def _seems_stable(family: Family) -> NDArray[np.bool_]:
    if not np.isfinite(family.matrices).all():
        return np.zeros(len(family.matrices), dtype=bool)
    size = np.abs(family.matrices).max(axis=(1, 2))
    continuous = family.system.time is Time.CONTINUOUS
    if SUSPICION * size.max() < family.limit if continuous else family.limit < 1 - SUSPICION:
        return np.ones(len(family.matrices), dtype=bool)
    eigenvalues = np.linalg.eigvals(family.matrices)
    if continuous:
        return np.asarray(eigenvalues.real.max(axis=1) < -SUSPICION * size)
    return np.asarray(np.abs(eigenvalues).max(axis=1) < 1 - SUSPICION)


def _first_unstable(modes: Iterable[Mode], family: Family) -> Finding:
    system, count, skipped = family.system, 0, 0
    for mode, fits in affordable(modes):
        if not fits:
            skipped += 1
            continue
        count += 1
        cost = exact_test_cost(mode.A)
        if cost.seconds > ALWAYS_TESTED:
            family.allowance.take(cost, f"the exact test of mode {mode.name}")
        if is_stable(mode.A, system.time):
            continue
        evidence = UnstableMode(mode.name, worst_eigenvalue(mode.A, system.time))
        if fault := evidence.find_fault(system):
            return None, f"mode {mode.name} is not stable, but {fault}"
        return evidence, f"mode {mode.name} is not stable"
    tested = f"{count} modes tested exactly, all stable" if count else "none"
    return None, tested + (f"; {skipped} not tried, their numbers are too large" * (skipped > 0))
