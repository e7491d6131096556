"""Chapters 6.3.2.2 and 6.4.1: the state matrices and their eigenvalues."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from nrs_design.loop.modes import Rows
from nrs_design.models.linear_form import LinearForm
from nrs_design.proof.spectrum import is_stable
from nrs_design.thesis import thesis
from nrs_design.thesis.comparison import Found, Number, Recomputed, format_number
from nrs_design.thesis.matrices import MOTION, family, impedance_rows, printed_rows


def results() -> Iterator[Found]:
    """Recompute the matrices entry by entry, and their eigenvalues."""
    num, den = thesis.EXACT_LOOP.numerator, thesis.EXACT_LOOP.denominator
    yield -den[2] / den[0], -den[1] / den[0]
    yield num[1] / den[0], num[0] / den[0]
    soft = impedance_rows(thesis.SOFT, "0.01", "2.15", "force")
    stiff = impedance_rows(thesis.STIFF, "0.01", "2.11", "force")
    yield float(MOTION.A[1][0])
    yield _floats(soft[3][:2])
    yield _floats(stiff[3][:2])
    yield from _floats((soft[2][2], soft[3][0], soft[3][1]))
    yield _spectrum(printed_rows("-215", ("70183.13", "1231.97")))
    yield _not_hurwitz(printed_rows("-104", ("70183.13", "1231.97")))
    yield _not_hurwitz(printed_rows("-211", ("99820.9", "1752.22")))
    yield _not_hurwitz(printed_rows("-410", ("79666.19", "1222.89")))
    for Bt in ("2.15", "1.04"):
        yield _spectrum(impedance_rows(thesis.SOFT, "0.01", Bt, "deflection"))


def _not_hurwitz(rows: Rows) -> Recomputed:
    system = family("printed", rows)
    found = ", ".join(map(format_number, _spectrum(rows)))
    return Recomputed(found, not is_stable(system.modes[0].A, system.time))


def _spectrum(rows: Rows) -> tuple[Number, ...]:
    """Return the eigenvalues, rightmost first, one for each complex pair."""
    found = np.linalg.eigvals(np.array(rows, dtype=float))
    upper = sorted(found[found.imag >= 0], key=lambda z: (-z.real, z.imag))
    return tuple(complex(z) if z.imag else float(z.real) for z in upper)


def _floats(entries: LinearForm) -> tuple[float, ...]:
    return tuple(map(float, entries))
