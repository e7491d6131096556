"""Numbers as a reader wants them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence


def number(value: float, digits: int = 4) -> str:
    """Write a number with so many significant digits; infinity is ``unlimited``."""
    if math.isinf(value):
        return "unlimited"
    # Rounded first, so that 5520 does not come out as 5.52e+03.
    return f"{float(f'{value:.{digits}g}'):.15g}"


def root(value: complex, digits: int = 4) -> str:
    """Write a pole or eigenvalue; a pair is written once, by its upper member."""
    if abs(value.imag) <= 1e-9 * abs(value):
        return number(value.real, digits)
    return f"{number(value.real, digits)} ± {number(abs(value.imag), digits)}j"


def roots(values: Iterable[complex], digits: int = 4) -> str:
    """Write poles, every pair once."""
    return ", ".join(root(z, digits) for z in values if z.imag >= -1e-9 * abs(z))


def polynomial_text(coefficients: Sequence[float], digits: int = 5) -> str:
    """Write a polynomial in s, highest power first."""
    degree = len(coefficients) - 1
    powers = {0: "", 1: " s"}
    terms = [
        f"{number(c, digits)}{powers.get(degree - i, f' s^{degree - i}')}"
        for i, c in enumerate(coefficients)
        if c != 0
    ]
    return (" + ".join(terms) or "0").replace("+ -", "- ")


def shortened(names: Sequence[str], limit: int = 12) -> str:
    """List names, only the first of many."""
    shown = ", ".join(names[:limit])
    return shown if len(names) <= limit else f"{shown} and {len(names) - limit} more"
