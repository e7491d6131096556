"""One printed number of the thesis beside the recomputed one, and what the comparison says."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from math import isfinite

Number = float | complex
Value = Number | Sequence[Number]
Printed = str | tuple[str, ...]

# Digits that a recomputed value shows, unless the print has more.
DIGITS = 6
# The precision that a print is read with: a number is reproduced if it is this near, relative to
# it, or nearer than one unit of its last printed digit. How far our own value may be from the
# reference that this package has on record is another thing: the `Tolerance` of each row.
STANDARD = 1e-3
CUT_OFF = "Cut off in print, not rounded."
BECAUSE = "Not reproducible, because"


class PrintVerdict(StrEnum):
    """What the comparison of print and recomputed value says."""

    REPRODUCED = "reproduced"
    PRINTED_DIFFERENTLY = "printed differently"
    FITTED = "fitted"
    DERIVED = "derived"
    NOT_REPRODUCIBLE = "not reproducible"
    DRIFT = "drift"


@dataclass(frozen=True, slots=True)
class ReproducedValue:
    """One line of the table."""

    name: str  # The quantity
    section: str  # Where the thesis prints it
    printed: str  # As printed
    value: str | None  # As recomputed; None where nothing can be computed
    unit: str  # Of both
    # Difference between value and print over the print (the difference itself where the print is
    # zero), the largest one of several numbers; None where the print is not a number.
    deviation: float | None
    # ``drift`` says that the package no longer computes what this row has on record.
    verdict: PrintVerdict
    note: str  # What is right, and why; or why nothing can be recomputed
    # How near to the print a value must be to reproduce it, number by number: a part of the print,
    # or a unit of its last digit; empty where words are compared.
    precision: str = ""
    # As `deviation`, but from the reference that this package has on record for its own value,
    # which is the print where nothing else is.
    drift: float | None = None
    limit: str = ""  # The largest such difference that is no drift
    # Constants that were fitted to prints and that the value rests on, with their numbers.
    fitted: str = ""
    # Errors of the print that the row touches, see `nrs_design.thesis.errata`.
    errata: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Tolerance:
    """How far a value may be from our reference, entry by entry: relative to it, or absolute."""

    relative: float = 0.0
    absolute: float = 0.0

    def __str__(self) -> str:
        """Write it as a part of the number, or in its unit."""
        parts = [f"{100 * self.relative:.15g} %"] if self.relative else []
        return " or ".join(parts + ([f"{self.absolute:g}"] if self.absolute else []))

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
    errata: tuple[str, ...] = (),
) -> ReproducedValue:
    """Return the row of a print that the recomputed value confirms.

    Parameters
    ----------
    name, section, unit, note, errata
        See `ReproducedValue`.
    printed : str or tuple of str
        Numbers, ``a +- bj`` for a pair of poles.
    value : number or sequence of numbers
        Recomputed.
    tolerance : Tolerance
        A value outside it makes the row a drift.
    right : str or tuple of str, optional
        Our reference, where it has more digits than the print; the tolerance is about it.
    """
    values, reference = _sequence(value), right or printed
    near = not _is_numeric(printed) or meets_standard(values, printed)
    agrees = near and tolerance.allows(values, _numbers(reference))
    verdict = PrintVerdict.REPRODUCED if agrees else PrintVerdict.DRIFT
    if agrees and _is_cut_off(values, printed):
        note = f"{note} {CUT_OFF}".strip()
    found = _row(name, section, printed, values, unit, verdict, note, tolerance, reference)
    return replace(found, errata=errata)


def fitted(
    name: str,
    section: str,
    printed: Printed,
    value: Value,
    unit: str,
    tolerance: Tolerance,
    *,
    constants: str,
    right: Printed | None = None,
    note: str = "",
    errata: tuple[str, ...] = (),
) -> ReproducedValue:
    """Return the row of a print that is met because a constant was fitted for it.

    Parameters
    ----------
    name, section, printed, value, unit, tolerance, right, note, errata
        As for `reproduced`.
    constants : str
        What was fitted, with its number.
    """
    values, reference = _sequence(value), right or printed
    agrees = tolerance.allows(values, _numbers(reference))
    verdict = PrintVerdict.FITTED if agrees else PrintVerdict.DRIFT
    found = _row(name, section, printed, values, unit, verdict, note, tolerance, reference)
    return replace(found, fitted=constants, errata=errata)


def derived(
    name: str,
    section: str,
    value: Value | str,
    unit: str = "",
    *,
    printed: str = "",
    right: Printed | None = None,
    tolerance: Tolerance | None = None,
    holds: bool = True,
    note: str,
    errata: tuple[str, ...] = (),
) -> ReproducedValue:
    """Return the row of a result that the thesis prints no number for.

    Parameters
    ----------
    name, section, unit
        As for `reproduced`.
    value : str, number or sequence of numbers
        What follows.
    printed : str
        What it follows from, or what the thesis says instead; it is not held against the value.
    right : str or tuple of str, optional
        What the value is on record to be.
    tolerance : Tolerance, optional
        About `right`.
    holds : bool
        Whether the computation still says so; if not, the row is a drift.
    note : str
        What it means.
    errata : tuple of str
        As for `reproduced`.
    """
    if isinstance(value, str):
        verdict = PrintVerdict.DERIVED if holds else PrintVerdict.DRIFT
        return ReproducedValue(
            name, section, printed, value, unit, None, verdict, note, errata=errata
        )
    values, tolerance = _sequence(value), tolerance or Tolerance(STANDARD)
    reference = _numbers(right or ())
    confirmed = holds and tolerance.allows(values, reference)
    verdict = PrintVerdict.DERIVED if confirmed else PrintVerdict.DRIFT
    return ReproducedValue(
        name,
        section,
        printed,
        ", ".join(format_number(number) for number in values),
        unit,
        None,
        verdict,
        note,
        drift=_deviation(values, reference),
        limit=str(tolerance),
        errata=errata,
    )


def near(
    name: str,
    section: str,
    printed: Printed,
    value: Value,
    unit: str,
    tolerance: Tolerance,
    *,
    right: Printed,
    because: str,
    note: str = "",
    constants: str = "",
) -> ReproducedValue:
    """Return the row of a print that is only come near, for want of data in the thesis.

    The row is a drift if the value leaves the tolerance around our reference, or if it meets the
    print after all.

    Parameters
    ----------
    name, section, printed, value, unit, tolerance, note
        As for `reproduced`.
    right : str or tuple of str
        Our reference.
    because : str
        What is missing; a clause, to which `note` adds sentences.
    constants : str
        As for `fitted`.
    """
    values = _sequence(value)
    confirmed = tolerance.allows(values, _numbers(right)) and not meets_standard(values, printed)
    verdict = PrintVerdict.NOT_REPRODUCIBLE if confirmed else PrintVerdict.DRIFT
    note = f"{BECAUSE} {because}. {note}".strip()
    found = _row(name, section, printed, values, unit, verdict, note, tolerance, right)
    return replace(found, fitted=constants)


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
    errata: tuple[str, ...],
) -> ReproducedValue:
    """Return the row of a print that is wrong; parameters as in `reproduced`.

    The row is a drift if the value leaves the tolerance around what is `right`, or if the print
    turns out to meet the standard.

    Parameters
    ----------
    name, section, printed, value, unit, tolerance
        As for `reproduced`.
    right : str or tuple of str
        What should be printed.
    note : str
        Why.
    errata : tuple of str
        The errors behind it.
    """
    values = _sequence(value)
    confirmed = tolerance.allows(values, _numbers(right))
    if _is_numeric(printed) and meets_standard(values, printed):
        confirmed = False
    verdict = PrintVerdict.PRINTED_DIFFERENTLY if confirmed else PrintVerdict.DRIFT
    found = _row(name, section, printed, values, unit, verdict, note, tolerance, right)
    return replace(found, errata=errata)


def meets_standard(values: Sequence[Number], printed: Printed) -> bool:
    """Tell whether all values are as near to their print as `STANDARD` or its digits ask for."""
    texts, target = _texts(printed), _numbers(printed)
    return len(values) == len(target) and all(
        abs(v - p) <= max(STANDARD * abs(p), _last_digit(text))
        for v, p, text in zip(values, target, texts, strict=True)
    )


def _is_cut_off(values: Sequence[Number], printed: Printed) -> bool:
    """Tell whether a print has the digits of its value, but is not rounded from it."""
    if not _is_numeric(printed):
        return False
    pairs = zip(values, _numbers(printed), map(_last_digit, _texts(printed)), strict=True)
    return any(
        isinstance(v, float) and p and digit / 2 < abs(v) - abs(p) < digit for v, p, digit in pairs
    )


def _last_digit(text: str) -> float:
    """Return one unit of the last digit of a printed number, of a pair of its coarser part."""
    return max(_unit(part) for part in text.removesuffix("j").split("+-"))


def _unit(text: str) -> float:
    mantissa, _, exponent = text.strip().partition("e")
    decimals = len(mantissa.partition(".")[2])
    return float(10.0 ** (int(exponent or 0) - decimals))


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
    errata: tuple[str, ...] = (),
) -> ReproducedValue:
    """Return the row of a statement in words.

    Parameters
    ----------
    name, section, printed, value, unit, note, errata
        See `ReproducedValue`; `value` says what was found.
    verdict : PrintVerdict
        What is on record.
    holds : bool
        Whether the computation still says so; if not, the row is a drift.
    """
    verdict = verdict if holds else PrintVerdict.DRIFT
    return ReproducedValue(name, section, printed, value, unit, None, verdict, note, errata=errata)


def omitted(
    name: str,
    section: str,
    printed: str,
    unit: str,
    because: str,
    errata: tuple[str, ...] = (),
) -> ReproducedValue:
    """Return the row of a print that cannot be recomputed.

    Parameters
    ----------
    name, section, printed, unit, errata
        As for `reproduced`.
    because : str
        Why not: what is missing, or that only the machine can show it; a clause.
    """
    verdict, note = PrintVerdict.NOT_REPRODUCIBLE, f"{BECAUSE} {because}."
    return ReproducedValue(name, section, printed, None, unit, None, verdict, note, errata=errata)


def drifted(rows: Sequence[ReproducedValue]) -> tuple[ReproducedValue, ...]:
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
    tolerance: Tolerance,
    reference: Printed,
) -> ReproducedValue:
    text = printed if isinstance(printed, str) else ", ".join(printed)
    numeric = _is_numeric(printed)
    digits = max(DIGITS, _significant_digits(text)) if numeric else DIGITS
    return ReproducedValue(
        name,
        section,
        text,
        ", ".join(format_number(number, digits) for number in values),
        unit,
        _deviation(values, _numbers(printed)) if numeric else None,
        verdict,
        note,
        precision=_precision(printed) if numeric else "",
        drift=_deviation(values, _numbers(reference)),
        limit=str(tolerance),
    )


def _precision(printed: Printed) -> str:
    """Write what `meets_standard` asks for, number by number; equal ones once."""
    found = (
        f"{digit:g}" if digit > STANDARD * abs(number) else str(Tolerance(STANDARD))
        for number, digit in zip(_numbers(printed), map(_last_digit, _texts(printed)), strict=True)
    )
    return ", ".join(dict.fromkeys(found))


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
    return tuple(map(_number, _texts(printed)))


def _texts(printed: Printed) -> tuple[str, ...]:
    return (printed,) if isinstance(printed, str) else printed


def _number(text: str) -> Number:
    real, pair, imaginary = text.partition("+-")
    return complex(float(real), float(imaginary.strip().removesuffix("j"))) if pair else float(real)
