"""Comparison of one printed number of the thesis with the recomputed one."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from functools import cache, partial
from importlib.resources import files
from math import isfinite
from typing import Any


@dataclass(frozen=True, slots=True)
class Erratum:
    """One error or gap of the print."""

    id: str  # Short name, which rows use
    where: str  # Sections, equations or tables
    about: str  # Description


@cache
def errata() -> tuple[Erratum, ...]:
    """Return all of them, in the order of the thesis."""
    return tuple(Erratum(**entry) for entry in read_data("errata.yaml"))


@cache
def read_data(name: str) -> Any:
    """Return what a data file of this package holds."""
    from ruamel.yaml import YAML

    text = files("nrs_design.thesis").joinpath(name).read_text(encoding="utf-8")
    return YAML(typ="safe", pure=True).load(text)


Number = float | complex
Value = Number | Sequence[Number]
Printed = str | tuple[str, ...]

# Digits that a recomputed value shows, unless the print has more.
DIGITS = 6
# Precision of a print: a value reproduces a number within this relative difference, or within a
# unit of the last printed digit. The `Tolerance` of a row limits the difference between value and
# reference.
STANDARD = 1e-3
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
    section: str  # Place in the thesis
    printed: str  # As printed
    value: str | None  # As recomputed; None where nothing can be computed
    unit: str  # Of both
    # Largest relative difference between value and print (absolute for a print of zero); None for a
    # comparison without numbers.
    deviation: float | None
    # ``drift``: the package no longer computes the value on record.
    verdict: PrintVerdict
    note: str  # What is right, and why; or why nothing can be recomputed
    # Required precision of each number: a percentage, or a unit of the last digit; empty for texts.
    precision: str = ""
    # Like `deviation`, from the reference on record; without a reference, from the print.
    drift: float | None = None
    limit: str = ""  # The largest such difference that is no drift
    # Constants that were fitted to prints and that the value rests on, with their numbers.
    fitted: str = ""
    # Errors of the print that the row touches, see `nrs_design.thesis.comparison`.
    errata: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Tolerance:
    """Largest deviation of each entry from the reference, relative or absolute."""

    relative: float = 0.0
    absolute: float = 0.0

    def __str__(self) -> str:
        """Write the tolerance in percent, or in the unit of the number."""
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


@dataclass(frozen=True, slots=True)
class PrintedRow:
    """A line of `rows.yaml`: the print, and the verdict on record."""

    verdict: str  # A `PrintVerdict`, as long as the value is what is on record
    name: str
    section: str
    printed: Printed = ""
    unit: str = ""
    value: str | None = None  # Correct statement as text; numbers are computed
    right: Printed = ""  # Reference, if different from the print
    # Largest deviation from the reference that is no drift, relative or absolute.
    relative: float = 0.0
    absolute: float = 0.0
    because: str = ""  # Reason for not reproducible, as a clause
    fitted: str = ""
    note: str = ""
    errata: tuple[str, ...] = ()

    @property
    def is_computed(self) -> bool:
        """Whether there is a result, if only of its note."""
        is_missing = self.verdict == PrintVerdict.NOT_REPRODUCIBLE
        return not is_missing or bool(self.right) or "{}" in self.because


@dataclass(frozen=True, slots=True)
class Recomputed:
    """What is computed for a row."""

    value: Value | str | None = None  # Text or numbers; None for the text of the row
    is_confirmed: bool = True  # Whether the computation confirms the record
    facts: tuple[object, ...] = ()  # Values for the braces in note and `because`


# A result, a value alone, or a truth value.
Result = Recomputed | Value | str | bool


@cache
def printed_rows_of(topic: str) -> tuple[PrintedRow, ...]:
    """Return the rows of a topic, as they are on record."""
    entries: list[dict[str, Any]] = read_data("rows.yaml")[topic]
    return tuple(
        PrintedRow(**{key: _fixed(value) for key, value in one.items()}) for one in entries
    )


def _fixed(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value


def compare_topic(topic: str, outcomes: Iterable[Result]) -> tuple[ReproducedValue, ...]:
    """Return the rows of a topic with their results, in the order of `rows.yaml`."""
    rows, results = printed_rows_of(topic), list(outcomes)
    if len(results) != sum(row.is_computed for row in rows):
        raise ValueError(f"{topic}: {len(results)} results for the rows that are computed")
    left = iter(results)
    return tuple(judge(row, next(left) if row.is_computed else Recomputed()) for row in rows)


def judge(row: PrintedRow, outcome: Result) -> ReproducedValue:
    """Hold a result against the print and against what is on record.

    A value that leaves its tolerance makes the row a drift, and so does one that meets a print
    that is on record as missed, or misses one that is on record as met.
    """
    if isinstance(outcome, bool):
        outcome = Recomputed(is_confirmed=outcome)
    result = outcome if isinstance(outcome, Recomputed) else Recomputed(outcome)
    because, note = (text.format(*result.facts) for text in (row.because, row.note))
    if because:
        note = f"{BECAUSE} {because}. {note}".strip()
    verdict, printed = PrintVerdict(row.verdict), row.printed
    text = printed if isinstance(printed, str) else ", ".join(printed)
    build = partial(
        ReproducedValue, row.name, row.section, text, fitted=row.fitted, errata=row.errata
    )
    if result.value is None or isinstance(result.value, str):
        words = row.value if result.value is None else result.value
        verdict = verdict if result.is_confirmed else PrintVerdict.DRIFT
        return build(words, row.unit, None, verdict, note)
    values, reference = _sequence(result.value), _numbers(row.right or printed)
    compared = _is_numeric(printed) and verdict is not PrintVerdict.DERIVED
    tolerance = Tolerance(row.relative or (0.0 if row.absolute else STANDARD), row.absolute)
    agrees = result.is_confirmed and tolerance.allows(values, reference)
    if compared and verdict is not PrintVerdict.FITTED:
        agrees &= meets_standard(values, printed) == (verdict is PrintVerdict.REPRODUCED)
    digits = max(DIGITS, _significant_digits(text)) if compared else DIGITS
    return build(
        ", ".join(format_number(number, digits) for number in values),
        row.unit,
        _deviation(values, _numbers(printed)) if compared else None,
        verdict if agrees else PrintVerdict.DRIFT,
        note,
        precision=_precision(printed) if compared else "",
        drift=_deviation(values, reference),
        limit=str(tolerance),
    )


def meets_standard(values: Sequence[Number], printed: Printed) -> bool:
    """Tell whether all values agree with their print within `STANDARD` or one last digit."""
    texts, target = _texts(printed), _numbers(printed)
    return len(values) == len(target) and all(
        abs(v - p) <= max(STANDARD * abs(p), _last_digit(text))
        for v, p, text in zip(values, target, texts, strict=True)
    )


def _last_digit(text: str) -> float:
    """Return one unit of the last digit of a printed number, of a pair of its coarser part."""
    parts = (part.strip().partition("e") for part in text.removesuffix("j").split("+-"))
    return max(float(f"1e{int(e or 0) - len(digits.partition('.')[2])}") for digits, _, e in parts)


def drifted(rows: Sequence[ReproducedValue]) -> tuple[ReproducedValue, ...]:
    """Return the rows that no longer agree with the record."""
    return tuple(row for row in rows if row.verdict is PrintVerdict.DRIFT)


def format_number(value: Number, digits: int = DIGITS) -> str:
    """Write a number; a complex number stands for a conjugate pair."""
    if isinstance(value, complex) and value.imag:
        return f"{value.real:.{digits}g} +- {abs(value.imag):.{digits}g}j"
    return f"{value.real:.{digits}g}"


def _precision(printed: Printed) -> str:
    """Write the tolerance of `meets_standard` for each number; equal ones once."""
    texts = (
        f"{digit:g}" if digit > STANDARD * abs(number) else str(Tolerance(STANDARD))
        for number, digit in zip(_numbers(printed), map(_last_digit, _texts(printed)), strict=True)
    )
    return ", ".join(dict.fromkeys(texts))


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
