"""A decision as it is written in a paper: its P, and TeX."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from nrs_design.proof.bounds import lower, upper
from nrs_design.proof.evidence import AbstractEvidence
from nrs_design.proof.mode import Time

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


# Widths of one column and of both in papers of the IEEE, in.
WIDTHS = {"ieee": 3.5, "ieee-two": 7.16}
_DIGITS = 4


def form_of(evidence: AbstractEvidence | None) -> NDArray[np.float64] | None:
    """Return the P of one quadratic function in contact, shape (n, n); None of anything else."""
    known = None if evidence is None else evidence.quadratic
    if known is None:
        return None
    import numpy as np

    form, power = known
    return np.array([[float(Fraction(entry, 2**power)) for entry in row] for row in form])


def latex_of(
    name: str, verdict: str, rate: Fraction | None, time: Time, P: NDArray[np.float64] | None
) -> str:
    """Return verdict, rate and P of a decision in TeX; P is rounded for reading.

    Parameters
    ----------
    name, verdict : str
        Of the system.
    rate : Fraction or None
        What is proved: alpha in 1/s, in discrete time rho per step.
    time : Time
        Continuous or discrete.
    P : ndarray, shape (n, n), or None
        Of one quadratic function.
    """
    lines = [f"% {name}: {verdict}"]
    if rate is not None and time is Time.CONTINUOUS:
        lines.append(rf"$\alpha \ge {_power(lower(rate, _DIGITS))}\,\mathrm{{s}}^{{-1}}$")
    elif rate is not None:
        lines.append(rf"$\rho \le {_power(upper(rate, _DIGITS))}$ per step")
    if P is not None:
        rows = r" \\ ".join(
            " & ".join(_power(f"{entry:.{_DIGITS}g}") for entry in row) for row in P.tolist()
        )
        lines.append(rf"$P \approx \begin{{bmatrix}} {rows} \end{{bmatrix}}$")
    return "\n".join(lines)


def _power(text: str) -> str:
    """Write a decimal exponent as a power of ten."""
    digits, mark, exponent = text.partition("e")
    return rf"{digits} \cdot 10^{{{int(exponent)}}}" if mark else text
