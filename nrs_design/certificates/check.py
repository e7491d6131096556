"""TRUSTED: does the evidence hold for the system? Exact, and without any solver."""

from __future__ import annotations

from nrs_design.certificates.certificate import CommonQuadratic, Evidence, UnstableMode
from nrs_design.certificates.exact import (
    is_hurwitz,
    is_positive_definite,
    is_schur,
    is_symmetric,
    lyapunov_decrease,
    stein_decrease,
)
from nrs_design.switched.system import Mode, SwitchedSystem, Time


def find_fault(system: SwitchedSystem, evidence: Evidence) -> str | None:
    """Check evidence against a system.

    Parameters
    ----------
    system : SwitchedSystem
        Assembled from the spec.
    evidence : CommonQuadratic or UnstableMode
        What is said to prove or refute its stability.

    Returns
    -------
    str or None
        Why the evidence does not hold, or None if it holds.
    """
    if isinstance(evidence, UnstableMode):
        return _fault_of_unstable_mode(system, evidence)
    return _fault_of_common_quadratic(system, evidence)


def is_stable(mode: Mode, time: Time) -> bool:
    """Decide whether one mode is Hurwitz (continuous time) or Schur (discrete time)."""
    if time is Time.CONTINUOUS:
        return is_hurwitz(mode.A.numerators)
    return is_schur(mode.A.numerators, mode.A.denominator)


def decrease(mode: Mode, evidence: CommonQuadratic, time: Time) -> list[list[int]]:
    """Return the integer matrix that must be positive definite for one mode."""
    form = lyapunov_decrease if time is Time.CONTINUOUS else stein_decrease
    return form(mode.A.numerators, mode.A.denominator, evidence.Q, evidence.rate)


def _fault_of_common_quadratic(system: SwitchedSystem, evidence: CommonQuadratic) -> str | None:
    n, Q, rate = system.order, evidence.Q, evidence.rate
    if not system.modes:
        return "the system has no modes"
    if len(Q) != n or any(len(row) != n for row in Q) or not is_symmetric(Q):
        return f"Q is not a symmetric {n} x {n} matrix"
    if rate <= 0 or (system.time is Time.DISCRETE and rate >= 1):
        return "the claimed rate is not one of exponential decay"
    if not is_positive_definite(Q):
        return "Q is not positive definite"
    for mode in system.modes:
        if mode.A.shape != (n, n) or mode.A.denominator <= 0:
            return f"mode {mode.name} is not an {n} x {n} matrix over a positive denominator"
        if not is_positive_definite(decrease(mode, evidence, system.time)):
            return (
                f"the Lyapunov function does not decrease at the claimed rate in mode {mode.name}"
            )
    return None


def _fault_of_unstable_mode(system: SwitchedSystem, evidence: UnstableMode) -> str | None:
    named = [mode for mode in system.modes if mode.name == evidence.mode]
    if len(named) != 1:
        return f"there is no single mode named {evidence.mode}"
    return f"mode {evidence.mode} is stable" if is_stable(named[0], system.time) else None
