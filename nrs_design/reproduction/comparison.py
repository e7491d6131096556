"""One printed number of the thesis beside the recomputed one, and what the comparison says."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from math import isfinite

Number = float | complex
Value = Number | Sequence[Number]
Printed = str | tuple[str, ...]

# Digits that a recomputed value shows, unless the print has more.
DIGITS = 6


class PrintVerdict(StrEnum):
    """What the comparison of print and recomputed value says."""

    REPRODUCED = "reproduced"
    PRINT_IS_WRONG = "print is wrong"
    HARDWARE_ONLY = "hardware only"
    OMITTED_DATA = "needs data that the thesis omits"
    DRIFT = "drift"


@dataclass(frozen=True, slots=True)
class Comparison:
    """One line of the table.

    Parameters
    ----------
    name : str
        The quantity.
    section : str
        Where the thesis prints it.
    printed : str
        As printed.
    value : str or None
        As recomputed; None where nothing can be computed.
    unit : str
        Of both.
    deviation : float or None
        Difference between value and print over the print (the difference itself where the print
        is zero), the largest one of several numbers; None where the print is not a number.
    verdict : PrintVerdict
        ``drift`` says that the package no longer computes what this row has on record.
    note : str
        Where the print is wrong: what is right, and why.
    """

    name: str
    section: str
    printed: str
    value: str | None
    unit: str
    deviation: float | None
    verdict: PrintVerdict
    note: str


@dataclass(frozen=True, slots=True)
class Tolerance:
    """How far a value may be from its target, entry by entry: relative to it, or absolute."""

    relative: float = 0.0
    absolute: float = 0.0

    def allows(self, value: Sequence[Number], target: Sequence[Number]) -> bool:
        """Tell whether a value agrees with its target; NaN agrees with nothing."""
        if len(value) != len(target):
            return False
        return all(
            abs(v - t) <= max(self.absolute, self.relative * abs(t))
            for v, t in zip(value, target, strict=True)
        )


def reproduced(
    name: str,
    section: str,
    printed: Printed,
    value: Value,
    unit: str,
    tolerance: Tolerance,
    *,
    right: Printed | None = None,
    note: str = "",
) -> Comparison:
    """Return the row of a print that the recomputed value confirms.

    Parameters
    ----------
    name, section, unit, note : str
        See `Comparison`.
    printed : str or tuple of str
        Numbers, ``a +- bj`` for a pair of poles.
    value : number or sequence of numbers
        Recomputed.
    tolerance : Tolerance
        A value outside it makes the row a drift.
    right : str or tuple of str, optional
        More digits than the print has; the tolerance then is about these.
    """
    values, target = _sequence(value), _numbers(right or printed)
    verdict = PrintVerdict.REPRODUCED if tolerance.allows(values, target) else PrintVerdict.DRIFT
    return _row(name, section, printed, values, unit, verdict, note)


def misprint(
    name: str,
    section: str,
    printed: Printed,
    value: Value,
    unit: str,
    tolerance: Tolerance,
    *,
    right: Printed,
    note: str,
) -> Comparison:
    """Return the row of a print that is wrong; parameters as in `reproduced`.

    The row is a drift if the value leaves the tolerance around what is `right`, or if the print
    turns out to be within it.

    Parameters
    ----------
    name, section, printed, value, unit, tolerance
        As for `reproduced`.
    right : str or tuple of str
        What should be printed.
    note : str
        Why.
    """
    values = _sequence(value)
    confirmed = tolerance.allows(values, _numbers(right))
    printed_right = _is_numeric(printed) and tolerance.allows(_numbers(printed), values)
    verdict = PrintVerdict.PRINT_IS_WRONG if confirmed and not printed_right else PrintVerdict.DRIFT
    return _row(name, section, printed, values, unit, verdict, note)


def claim(
    name: str,
    section: str,
    printed: str,
    value: str,
    unit: str = "",
    *,
    verdict: PrintVerdict,
    holds: bool,
    note: str,
) -> Comparison:
    """Return the row of a statement in words.

    Parameters
    ----------
    name, section, printed, value, unit, note : str
        See `Comparison`; `value` says what was found.
    verdict : PrintVerdict
        What is on record.
    holds : bool
        Whether the computation still says so; if not, the row is a drift.
    """
    verdict = verdict if holds else PrintVerdict.DRIFT
    return Comparison(name, section, printed, value, unit, None, verdict, note)


def hardware_only(name: str, section: str, printed: str, unit: str, note: str = "") -> Comparison:
    """Return the row of a measurement on the robot.

    Parameters
    ----------
    name, section, printed, unit
        As for `reproduced`.
    note : str
        What it would take.
    """
    return Comparison(name, section, printed, None, unit, None, PrintVerdict.HARDWARE_ONLY, note)


def omitted(name: str, section: str, printed: str, unit: str, note: str) -> Comparison:
    """Return the row of a number whose data the thesis does not give.

    Parameters
    ----------
    name, section, printed, unit
        As for `reproduced`.
    note : str
        What is missing.
    """
    return Comparison(name, section, printed, None, unit, None, PrintVerdict.OMITTED_DATA, note)


def drifted(rows: Sequence[Comparison]) -> tuple[Comparison, ...]:
    """Return the rows that no longer agree with what is on record."""
    return tuple(row for row in rows if row.verdict is PrintVerdict.DRIFT)


def format_number(value: Number, digits: int = DIGITS) -> str:
    """Write a number, and a complex one as the pair that it stands for."""
    if isinstance(value, complex) and value.imag:
        return f"{value.real:.{digits}g} +- {abs(value.imag):.{digits}g}j"
    return f"{value.real:.{digits}g}"


def _row(
    name: str,
    section: str,
    printed: Printed,
    values: Sequence[Number],
    unit: str,
    verdict: PrintVerdict,
    note: str,
) -> Comparison:
    text = printed if isinstance(printed, str) else ", ".join(printed)
    deviation = _deviation(values, _numbers(printed)) if _is_numeric(printed) else None
    digits = max(DIGITS, _significant_digits(text)) if _is_numeric(printed) else DIGITS
    value = ", ".join(format_number(number, digits) for number in values)
    return Comparison(name, section, text, value, unit, deviation, verdict, note)


def _deviation(values: Sequence[Number], printed: Sequence[Number]) -> float | None:
    if len(values) != len(printed):
        return None
    parts = [abs(v - p) / (abs(p) or 1.0) for v, p in zip(values, printed, strict=True)]
    # JSON has neither NaN nor infinity; the row is a drift anyway.
    return max(parts) if all(map(isfinite, parts)) else None


def _significant_digits(text: str) -> int:
    """Count the digits of the longest number in a text, exponents and leading zeros left out."""
    numbers = (part.partition("e")[0] for part in re.split(r"[,+]", text))
    return max(len(re.sub(r"[^0-9]", "", number).lstrip("0")) for number in numbers)


def _sequence(value: Value) -> tuple[Number, ...]:
    return tuple(value) if isinstance(value, Sequence) else (value,)


def _is_numeric(printed: Printed) -> bool:
    try:
        _numbers(printed)
    except ValueError:
        return False
    return True


def _numbers(printed: Printed) -> tuple[Number, ...]:
    return tuple(_number(text) for text in ((printed,) if isinstance(printed, str) else printed))


def _number(text: str) -> Number:
    real, pair, imaginary = text.partition("+-")
    return complex(float(real), float(imaginary.strip().removesuffix("j"))) if pair else float(real)
