"""Chapters 6.3.2.2 and 6.4.1: the state matrices and their eigenvalues."""

from __future__ import annotations

import numpy as np

from nrs_design.models.linear_form import LinearForm
from nrs_design.proof.spectrum import is_stable
from nrs_design.switched.modes import Rows
from nrs_design.thesis import thesis
from nrs_design.thesis.comparison import (
    Number,
    PrintVerdict,
    ReproducedValue,
    Tolerance,
    claim,
    format_number,
    misprint,
    reproduced,
)
from nrs_design.thesis.matrices import (
    MOTION,
    family,
    impedance_rows,
    printed_rows,
)

CLOSE = Tolerance(1e-4)
# Errors of the print in these matrices.
_SIGN, _STIFFNESS = ("A(2,1)",), ("6.3.1 k_soft",)
_DAMPING, _DIGIT = ("6.4.1 A2(3,3)",), ("6.4.1 A2(4,1)",)
WRONG_SIGN = (
    "Entry (2, 1) is printed as +1618.80, where Ap has -1618.80: as printed the mode is unstable."
)


def rows() -> tuple[ReproducedValue, ...]:
    """Recompute the matrices entry by entry, and their eigenvalues."""
    return (*_realization(), *_entries(), *_eigenvalues())


def _realization() -> tuple[ReproducedValue, ...]:
    num, den = thesis.EXACT_LOOP.numerator, thesis.EXACT_LOOP.denominator
    return (
        reproduced(
            "Ap(2,1), Ap(2,2)",
            "6.12",
            ("-1618.80", "-56.89"),
            (-den[2] / den[0], -den[1] / den[0]),
            "1/s^2, 1/s",
            Tolerance(5e-4),
        ),
        reproduced(
            "Cp",
            "6.12",
            ("1618.80", "28.4160"),
            (num[1] / den[0], num[0] / den[0]),
            "1/s^2, 1/s",
            CLOSE,
        ),
    )


def _entries() -> tuple[ReproducedValue, ...]:
    soft = impedance_rows(thesis.SOFT, "0.01", "2.15", "force")
    stiff = impedance_rows(thesis.STIFF, "0.01", "2.11", "force")
    return (
        misprint(
            "A1, A2: entry (2,1)",
            "6.3.2.2",
            "1618.80",
            float(MOTION.A[1][0]),
            "1/s^2",
            CLOSE,
            right="-1618.80",
            note="Wrong sign, in 6.4.1 too: Ap of 6.12 has a minus.",
            errata=_SIGN,
        ),
        misprint(
            "A1, A2: entries (4,1), (4,2)",
            "6.3.2.2",
            ("70183.13", "1231.97"),
            _floats(soft[3][:2]),
            "N m/(rad s^2), N m/(rad s)",
            CLOSE,
            right=("69666.0", "1222.89"),
            note="Printed with 752.69 N/m (43.355 N m/rad); the design is for 43.0356 N m/rad, "
            "and A2 of 6.4.1 has that.",
            errata=_STIFFNESS,
        ),
        reproduced(
            "A1: entries (4,1), (4,2)",
            "6.4.1",
            ("99820.9", "1752.22"),
            _floats(stiff[3][:2]),
            "N m/(rad s^2), N m/(rad s)",
            CLOSE,
        ),
        misprint(
            "A2: entry (3,3)",
            "6.4.1",
            "-410",
            float(soft[2][2]),
            "1/s",
            CLOSE,
            right="-215",
            note="-Bt/Mt with the stated Bt = 2.15 and Mt = 0.01.",
            errata=_DAMPING,
        ),
        misprint(
            "A2: entry (4,1)",
            "6.4.1",
            "79666.19",
            float(soft[3][0]),
            "N m/(rad s^2)",
            CLOSE,
            right="69666.0",
            note="First digit: k_soft times 1618.80.",
            errata=_DIGIT,
        ),
        reproduced("A2: entry (4,2)", "6.4.1", "1222.89", float(soft[3][1]), "N m/(rad s)", CLOSE),
    )


def _eigenvalues() -> tuple[ReproducedValue, ...]:
    return (
        misprint(
            "eigenvalues of A1 as printed",
            "6.3.2.2",
            "Hurwitz",
            _spectrum(printed_rows("-215", ("70183.13", "1231.97"))),
            "1/s",
            CLOSE,
            right=("10.652 +- 17.710j", "-75.471", "-217.724"),
            note=WRONG_SIGN,
            errata=_SIGN + _STIFFNESS,
        ),
        _not_hurwitz(
            "A2", "6.3.2.2", printed_rows("-104", ("70183.13", "1231.97")), _SIGN + _STIFFNESS
        ),
        _not_hurwitz("A1", "6.4.1", printed_rows("-211", ("99820.9", "1752.22")), _SIGN),
        _not_hurwitz(
            "A2",
            "6.4.1",
            printed_rows("-410", ("79666.19", "1222.89")),
            _SIGN + _DAMPING + _DIGIT,
        ),
        _hurwitz("2.15", ("-14.694 +- 32.617j", "-25.031", "-217.470")),
        _hurwitz("1.04", ("-5.424 +- 39.978j", "-38.306", "-111.737")),
    )


def _not_hurwitz(name: str, section: str, rows: Rows, errata: tuple[str, ...]) -> ReproducedValue:
    system = family(name, rows)
    return claim(
        f"eigenvalues of {name} as printed",
        section,
        "Hurwitz",
        ", ".join(map(format_number, _spectrum(rows))),
        "1/s",
        verdict=PrintVerdict.PRINTED_DIFFERENTLY,
        holds=not is_stable(system.modes[0].A, system.time),
        note=WRONG_SIGN,
        errata=errata,
    )


def _hurwitz(Bt: str, right: tuple[str, ...]) -> ReproducedValue:
    return reproduced(
        f"eigenvalues at k_soft, Mt 0.01, Bt {Bt}",
        "6.3.2.2",
        "Hurwitz",
        _spectrum(impedance_rows(thesis.SOFT, "0.01", Bt, "deflection")),
        "1/s",
        CLOSE,
        right=right,
        note="With the sign of (2, 1) set right.",
    )


def _spectrum(rows: Rows) -> tuple[Number, ...]:
    """Return the eigenvalues, rightmost first, one for each complex pair."""
    found = np.linalg.eigvals(np.array(rows, dtype=float))
    upper = sorted(found[found.imag >= 0], key=lambda z: (-z.real, z.imag))
    return tuple(complex(z) if z.imag else float(z.real) for z in upper)


def _floats(entries: LinearForm) -> tuple[float, ...]:
    return tuple(map(float, entries))
