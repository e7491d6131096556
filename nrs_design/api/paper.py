"""A decision as it is written in a paper: its P, and TeX."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from fractions import Fraction
from typing import TYPE_CHECKING

from nrs_design.proof.bounds import lower, upper
from nrs_design.proof.evidence import AbstractEvidence
from nrs_design.proof.mode import Time

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


_DIGITS = 4
# Of gains, which are given as they ship.
_GAIN_DIGITS = 6
# Letters of what is a symbol, such as Bt or k_1, and no word.
_LONGEST_SYMBOL = 3


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
    """Return verdict, rate and P of a decision in TeX; P, shape (n, n), is rounded for reading.

    The rate is what is proved: alpha in 1/s, in discrete time rho per step.
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


def latex_of_gains(
    gains: Mapping[str, Mapping[str, str]], units: Mapping[str, Mapping[str, str]]
) -> str:
    """Return a line for each controller; a gain that is rounded for reading is said to be.

    Gains, as they ship, and their units are by controller and name.
    """
    lines = []
    for controller, own in gains.items():
        shown = ", ".join(
            f"${_symbol(name)} {_nearly(value)}{_unit(units[controller][name])}$"
            for name, value in own.items()
        )
        if shown:
            lines.append(f"% {controller}\n{shown}")
    return "\n".join(lines)


def latex_of_ranges(ranges: Iterable[tuple[str, float, float, str]]) -> str:
    """Return a line for each range (name, low, high, unit), its ends rounded outwards."""
    return "\n".join(
        rf"${_symbol(name)} \in [{_end(low, lower)},\, {_end(high, upper)}]"
        rf"{_unit(unit)}$"
        for name, low, high, unit in ranges
    )


def _nearly(value: str) -> str:
    """Return a number for reading, after the sign that says whether it is that number."""
    exact = Fraction(value)
    short = f"{float(exact):.{_GAIN_DIGITS}g}"
    sign = "=" if Fraction(short) == exact else r"\approx"
    return f"{sign} {_power(short)}"


def _symbol(name: str) -> str:
    """Write a name: of a gain, its first letter, and the others as an index; or in words."""
    if len(name) > _LONGEST_SYMBOL:
        words = name.replace("_", r"\ ")
        return rf"\mathrm{{{words}}}"
    first, rest = name[:1], name[1:].lstrip("_")
    return rf"{first}_{{\mathrm{{{rest}}}}}" if rest else first


def _unit(unit: str) -> str:
    spaced = unit.replace("*", r"\,").replace(" ", r"\,")
    return rf"\,\mathrm{{{spaced}}}" if unit else ""


def _end(value: float, rounded: Callable[[Fraction, int], str]) -> str:
    return _power(rounded(Fraction(value), _DIGITS)) if math.isfinite(value) else r"\infty"


def _power(text: str) -> str:
    """Write a decimal exponent as a power of ten."""
    digits, mark, exponent = text.partition("e")
    return rf"{digits} \cdot 10^{{{int(exponent)}}}" if mark else text
