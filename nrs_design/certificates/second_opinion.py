"""A second, independent opinion on every exact decision, by python-flint.

The trusted check decides; this module only has a right of veto. A disagreement is a defect of
this program or of flint and ends in InternalError, never in a verdict.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from nrs_design.certificates.certificate import CommonQuadratic, Evidence, UnstableMode
from nrs_design.certificates.check import decrease, is_stable
from nrs_design.errors import InternalError
from nrs_design.switched.system import Mode, SwitchedSystem, Time


def confirm(system: SwitchedSystem, evidence: Evidence) -> None:
    """Confirm evidence that the trusted check has accepted.

    Raises
    ------
    InternalError
        If flint comes to another conclusion.
    """
    if isinstance(evidence, CommonQuadratic):
        forms = [evidence.Q, *(decrease(mode, evidence, system.time) for mode in system.modes)]
        agreed = all(_has_positive_spectrum(form) for form in forms)
    else:
        mode = next(mode for mode in system.modes if mode.name == evidence.mode)
        agreed = not _is_surely_stable(mode, system.time)
    if not agreed:
        raise InternalError("the integer check and flint disagree about the same certificate")


def unstable_mode(mode: Mode, time: Time) -> UnstableMode | None:
    """Return the evidence against one mode, with its worst eigenvalue, or None if it is stable."""
    if is_stable(mode, time):
        return None
    centers = [complex(root) for root in _spectrum(mode)]
    worst = max(centers, key=lambda z: z.real if time is Time.CONTINUOUS else abs(z))
    return UnstableMode(mode.name, _text(worst))


def _has_positive_spectrum(M: Sequence[Sequence[int]]) -> bool:
    """Tell whether the characteristic polynomial of a symmetric matrix alternates in sign.

    All roots are real, so by Descartes' rule they are all positive iff it does.
    """
    from flint import fmpz_mat

    coefficients = fmpz_mat([list(row) for row in M]).charpoly().coeffs()
    n = len(coefficients) - 1
    return all((c > 0) == ((n - k) % 2 == 0) and c != 0 for k, c in enumerate(coefficients))


def _spectrum(mode: Mode) -> list[Any]:
    """Return rigorous enclosures of the eigenvalues."""
    from flint import fmpz_mat

    polynomial = fmpz_mat([list(row) for row in mode.A.numerators]).charpoly()
    roots: list[Any] = polynomial.complex_roots()
    return [root / mode.A.denominator for root, _ in roots]


def _is_surely_stable(mode: Mode, time: Time) -> bool:
    if time is Time.CONTINUOUS:
        return all(root.real < 0 for root in _spectrum(mode))
    return all(abs(root) < 1 for root in _spectrum(mode))


def _text(z: complex) -> str:
    if z.imag == 0 or abs(z.imag) < 1e-14 * abs(z):
        return f"{z.real:.6g}"
    return f"{z.real:.6g} +- {abs(z.imag):.6g}j"
