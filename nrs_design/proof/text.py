"""Exact numbers and foreign text, as the words of a message or a claim."""

from __future__ import annotations

from fractions import Fraction


def quoted(text: str) -> str:
    """Quote a piece of user text for a message, shortened and without control characters."""
    return repr(text if len(text) <= 40 else text[:37] + "...")


def counted(number: int, noun: str) -> str:
    """Write a number with a noun in its singular or plural."""
    ending = "es" if noun.endswith("ch") else "s"
    return f"{number} {noun}{ending * (number != 1)}"


def exact_text(number: Fraction) -> str:
    """Write a fraction as the shortest decimal if that is exact, as ``p/q`` otherwise."""
    try:
        text = repr(float(number)).removesuffix(".0")
    except OverflowError:
        return str(number)
    return text if Fraction(text) == number else str(number)
