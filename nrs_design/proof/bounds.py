"""Numbers in claims, as text: exact where that is short, else rounded to the side that stays true.

What is proved for a number holds for every weaker one, so a rounded number in a claim must be a
weaker one, and the reader must see that it is rounded.
"""

from __future__ import annotations

from decimal import ROUND_CEILING, ROUND_FLOOR, ROUND_HALF_EVEN, Context, Decimal
from fractions import Fraction
from math import inf, isfinite, nextafter

from nrs_design.proof.text import exact_text

# Digits of decimals that are longer, or have no end.
LONGEST = 14
DIGITS = 6


def lower(number: Fraction, digits: int = DIGITS) -> str:
    """Write a number that is not above: exactly if that is short, else rounded down."""
    return _exact(number) or _round(number, digits, ROUND_FLOOR)


def upper(number: Fraction, digits: int = DIGITS) -> str:
    """Write a number that is not below: exactly if that is short, else rounded up.

    One that is a little below 1 stays below it, as in ``1 - 2.5e-22``.
    """
    text = _exact(number) or _round(number, digits, ROUND_CEILING)
    if number < 1 <= Decimal(text):
        return f"1 - {lower(1 - number, digits)}"
    return text


def at_least(number: Fraction, unit: str = "") -> str:
    """Write a lower bound of a symbol, such as ``= 2.5 1/s``, or ``>= 0.333333 1/s`` if rounded."""
    return f"{'=' if _exact(number) else '>='} {lower(number)}{_with(unit)}"


def at_most(number: Fraction, unit: str = "") -> str:
    """Write an upper bound of a symbol, such as ``= 0.5``, or ``<= 0.666667`` if rounded."""
    return f"{'=' if _exact(number) else '<='} {upper(number)}{_with(unit)}"


def rounded_down(number: Fraction, unit: str = "") -> str:
    """Write a number that is not above, and say so if it is not exact."""
    return f"{lower(number)}{_with(unit)}{'' if _exact(number) else ' (rounded down)'}"


def rounded_up(number: Fraction, unit: str = "") -> str:
    """Write a number that is not below, and say so if it is not exact."""
    return f"{upper(number)}{_with(unit)}{'' if _exact(number) else ' (rounded up)'}"


def nearly(number: Fraction, unit: str = "") -> str:
    """Write a number of which no side is safe: exactly if that is short, else with ``about``."""
    exact = _exact(number)
    return f"{exact or 'about ' + _round(number, DIGITS, ROUND_HALF_EVEN)}{_with(unit)}"


def lower_float(number: Fraction) -> float:
    """Return a double that is not above."""
    return -upper_float(-number)


def upper_float(number: Fraction) -> float:
    """Return a double that is not below."""
    try:
        value = float(number)
    except OverflowError:
        return inf if number > 0 else nextafter(-inf, 0)
    return value if not isfinite(value) or Fraction(value) >= number else nextafter(value, inf)


def _exact(number: Fraction) -> str | None:
    text = exact_text(number)
    return text if len(text) <= LONGEST and "/" not in text else None


def _round(number: Fraction, digits: int, rounding: str) -> str:
    context = Context(prec=digits, rounding=rounding)
    quotient = context.divide(Decimal(number.numerator), Decimal(number.denominator))
    return str(quotient).replace("E", "e")


def _with(unit: str) -> str:
    return f" {unit}" if unit else ""
