"""Numbers as a reader wants them, and names from users as a page or a figure can show them."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterable, Sequence
from functools import cache

from nrs_design.printable import escaped, visible


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


def list_first(names: Sequence[str], limit: int = 12) -> str:
    """List names, only the first of many."""
    text = ", ".join(names[:limit])
    return text if len(names) <= limit else f"{text} and {len(names) - limit} more"


def drawable(text: str) -> str:
    """Return `visible` text with escapes for what the font of figures has no letter."""
    visible_text = visible(text)
    if visible_text.isascii():
        return visible_text
    letters = _letters()
    return "".join(c if ord(c) in letters else escaped(c) for c in visible_text)


def wrapped_label(text: str, width: int) -> str:
    """Return drawable text in full, on as many lines as it needs."""
    lines: list[str] = []
    # Break names of modes at their slashes.
    for part in drawable(text).replace("/", "/\0").split("\0"):
        for piece in textwrap.wrap(part, width, drop_whitespace=False) or [""]:
            if lines and len(lines[-1]) + len(piece) <= width:
                lines[-1] += piece
            else:
                lines.append(piece)
    return "\n".join(line.strip() for line in lines)


@cache
def _letters() -> frozenset[int]:
    from nrs_design.plotting import FT2Font, findfont

    return frozenset(FT2Font(findfont("DejaVu Sans")).get_charmap())
