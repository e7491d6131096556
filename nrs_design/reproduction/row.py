"""One printed number of the thesis beside the recomputed one, and what the comparison says."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

Number = float | complex
Value = Number | Sequence[Number]
Printed = str | tuple[str, ...]


class Verdict(StrEnum):
    """What the comparison of print and recomputed value says."""

    REPRODUCED = "reproduced"
    PRINT_IS_WRONG = "print is wrong"
    HARDWARE_ONLY = "hardware only"
    OMITTED_DATA = "needs data that the thesis omits"
    DRIFT = "drift"


@dataclass(frozen=True, slots=True)
class Row:
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
        Largest difference between value and print over the largest printed number; the
        difference itself where the print is zero; None where the print is not a number.
    verdict : Verdict
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
    verdict: Verdict
    note: str


@dataclass(frozen=True, slots=True)
class Tolerance:
    """How far two values may be apart: relative to the largest entry, or absolute."""

    relative: float = 0.0
    absolute: float = 0.0

    def allows(self, value: Sequence[Number], target: Sequence[Number]) -> bool:
        """Tell whether a value agrees with its target; NaN agrees with nothing."""
        if len(value) != len(target):
            return False
        bound = max(self.absolute, self.relative * max(map(abs, target)))
        return all(abs(v - t) <= bound for v, t in zip(value, target, strict=True))


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
) -> Row:
    """Return the row of a print that the recomputed value confirms.

    Parameters
    ----------
    name, section, unit, note : str
        See `Row`.
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
    verdict = Verdict.REPRODUCED if tolerance.allows(values, target) else Verdict.DRIFT
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
) -> Row:
    """Return the row of a print that is wrong; parameters as in `reproduced`.

    The row is a drift if the value leaves the tolerance around what is `right`, or if the print
    turns out to be within it.
    """
    values = _sequence(value)
    confirmed = tolerance.allows(values, _numbers(right))
    printed_right = _is_numeric(printed) and tolerance.allows(_numbers(printed), values)
    verdict = Verdict.PRINT_IS_WRONG if confirmed and not printed_right else Verdict.DRIFT
    return _row(name, section, printed, values, unit, verdict, note)


def claim(
    name: str, section: str, printed: str, value: str, *, verdict: Verdict, holds: bool, note: str
) -> Row:
    """Return the row of a statement in words.

    Parameters
    ----------
    name, section, printed, value, note : str
        See `Row`; `value` says in words what was found.
    verdict : Verdict
        What is on record.
    holds : bool
        Whether the computation still says so; if not, the row is a drift.
    """
    return Row(name, section, printed, value, "", None, verdict if holds else Verdict.DRIFT, note)


def hardware_only(name: str, section: str, printed: str, unit: str, note: str = "") -> Row:
    """Return the row of a measurement on the robot."""
    return Row(name, section, printed, None, unit, None, Verdict.HARDWARE_ONLY, note)


def omitted(name: str, section: str, printed: str, unit: str, note: str) -> Row:
    """Return the row of a number whose data the thesis does not give."""
    return Row(name, section, printed, None, unit, None, Verdict.OMITTED_DATA, note)


def drifted(rows: Sequence[Row]) -> tuple[Row, ...]:
    """Return the rows that no longer agree with what is on record."""
    return tuple(row for row in rows if row.verdict is Verdict.DRIFT)


def format_number(value: Number) -> str:
    """Write a number with six digits, and a complex one as the pair that it stands for."""
    if isinstance(value, complex) and value.imag:
        return f"{value.real:.6g} +- {abs(value.imag):.6g}j"
    return f"{value.real:.6g}"


def _row(
    name: str,
    section: str,
    printed: Printed,
    values: Sequence[Number],
    unit: str,
    verdict: Verdict,
    note: str,
) -> Row:
    text = printed if isinstance(printed, str) else ", ".join(printed)
    deviation = _deviation(values, _numbers(printed)) if _is_numeric(printed) else None
    value = ", ".join(map(format_number, values))
    return Row(name, section, text, value, unit, deviation, verdict, note)


def _deviation(values: Sequence[Number], printed: Sequence[Number]) -> float | None:
    if len(values) != len(printed):
        return None
    scale = max(map(abs, printed)) or 1.0
    return max(abs(v - p) for v, p in zip(values, printed, strict=True)) / scale


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
