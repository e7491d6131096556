"""Begin and cell separator of the table in a text file."""

from __future__ import annotations

import csv
import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from nrs_design.errors import DataError
from nrs_design.identification.tables.columns import (
    FULL_WORDS,
    UNITS,
    check_stated,
    read_name,
    read_unit,
)

MAX_COLUMNS = 1000
MAX_NAME = 100
# Blanks, None, come last: names may hold them.
SEPARATORS = (",", ";", "\t", None)
UNDECIDED = "save it with a decimal point and without marks between thousands"
# Quantities of a line of units.
_MEASURED = ("time", "deflection", "force", "angle", "torque", "velocity", "command")

_DECIMAL_COMMA = re.compile(r"^[+-]?\d+,\d+([eE][+-]?\d+)?$")
_THOUSANDS = re.compile(r"^[+-]?[1-9]\d{0,2}(,\d{3})+$")
_BRACKETS = re.compile(r"^[\[({](.*)[\])}]$")


@dataclass(frozen=True, slots=True)
class Header:
    """How a text file is to be read."""

    names: list[str]  # Names of the columns, with the units of the next line if it has units
    separator: str | None  # Between cells; None for any number of blanks
    decimal_comma: bool  # Whether numbers have a decimal comma
    line: int  # Last line above the rows
    synthetic: bool  # Whether a comment above says so

    def cells(self, text: str) -> list[str]:
        """Split a row."""
        return split_cells(text, self.separator)


def read_header(
    lines: Sequence[str], path: Path, mapped: Mapping[str, str], example: str
) -> Header:
    """Find the line of names among the first ones: below a preamble, above the first row."""
    at, separator = _find(lines, mapped, path, example)
    names = _names(lines[at], separator, path, at + 1)
    below = _below_blanks(lines, at + 1)
    units = split_cells(lines[below], separator) if below < len(lines) else []
    if _are_units(units, len(names)):
        bare = [match[1] if (match := _BRACKETS.match(unit)) else unit for unit in units]
        names = [_add_unit(*pair, mapped, path) for pair in zip(names, bare, strict=True)]
        below = _below_blanks(lines, below + 1)
    cells = [cell for text in lines[below:] for cell in split_cells(text, separator) if "," in cell]
    if cells and all(_THOUSANDS.match(cell) for cell in cells):
        raise DataError(
            f"{cells[0]!r} may be {cells[0].replace(',', '.')} or {cells[0].replace(',', '')}",
            path=path,
            line=below + 1,
            remedy=UNDECIDED,
        )
    comma = any(_DECIMAL_COMMA.match(cell) for cell in cells)
    synthetic = any(text.startswith("#") and "synthetic" in text.lower() for text in lines[:at])
    return Header(names, separator, comma, below, synthetic)


def read_decimal(text: str) -> float | None:
    """Return the number that a cell is; None for other text, such as ``1_0``."""
    try:
        return float(text) if "_" not in text and text.isascii() else None
    except ValueError:
        return None


def split_cells(text: str, separator: str | None) -> list[str]:
    """Split a line; one that hides its names behind a comment sign is a header all the same."""
    text = text.strip(" ").removeprefix("#").removeprefix("%").lstrip(" ")
    if '"' in text and separator is not None:
        try:
            return [cell.strip() for cell in next(csv.reader([text], delimiter=separator))]
        except csv.Error:
            return []
    return [cell.strip() for cell in text.split(separator)]


def _find(
    lines: Sequence[str], mapped: Collection[str], path: Path, example: str
) -> tuple[int, str | None]:
    """Return the line with the most names that are known, else the first one, to complain of."""
    scores = [
        (sum(_counts_as_name(name, mapped) for name in split_cells(text, separator)), -at, -rank)
        for at, text in enumerate(lines)
        for rank, separator in enumerate(SEPARATORS)
    ]
    best, at, rank = max(scores, default=(0, 0, 0))
    if best >= 2:
        return -at, SEPARATORS[-rank]
    first = next((at for at, text in enumerate(lines) if text and text[0] != "#"), None)
    if first is None:
        raise DataError("has no header line", path=path, remedy="name the columns in a line")
    separator = max(SEPARATORS[:3], key=lambda s: lines[first].count(s or ","))
    if any(read_decimal(cell) is not None for cell in split_cells(lines[first], separator)):
        raise DataError(
            "begins with numbers, not with the names of its columns",
            path=path,
            line=first + 1,
            remedy=f"add a header such as {example}",
        )
    return first, separator


def _below_blanks(lines: Sequence[str], at: int) -> int:
    """Return the first line that is not empty, if there is one."""
    return next((i for i in range(at, len(lines)) if lines[i]), at)


def _counts_as_name(name: str, mapped: Collection[str]) -> bool:
    found = read_name(name)
    if name in mapped or name.lower() in FULL_WORDS:
        return True
    return found is not None and (found.is_known or not found.unit)


def _names(text: str, separator: str | None, path: Path, line: int) -> list[str]:
    names = split_cells(text, separator)
    fault, remedy = "", "save the columns that are needed, under short names"
    if "\r" in text:
        fault = "has a header line that is no CSV: a line end stands within it"
        remedy = "save it with one header line and line ends of one kind"
    elif len(names) > MAX_COLUMNS or max(map(len, names), default=0) > MAX_NAME:
        fault = f"has more than {MAX_COLUMNS} columns, or a name of over {MAX_NAME} letters"
    if fault:
        raise DataError(fault, path=path, line=line, remedy=remedy)
    return names


def _are_units(cells: Sequence[str], width: int) -> bool:
    """Tell whether a line below the names holds their units, such as ``(s);(mm);(N)``."""
    if (
        len(cells) != width
        or not any(cells)
        or any(read_decimal(cell) is not None for cell in cells)
    ):
        return False
    return all(
        not cell or _BRACKETS.match(cell) or any(read_unit(cell, q) in UNITS[q] for q in _MEASURED)
        for cell in cells
    )


def _add_unit(name: str, unit: str, mapped: Mapping[str, str], path: Path) -> str:
    """Return a name with the unit of the line below, which must not contradict a mapping."""
    if name in mapped:
        check_stated(name, f"column [{unit}]", mapped[name], partial(DataError, path=path))
        return name
    found = read_name(name)
    return name if not unit or (found is not None and found.is_known) else f"{name} [{unit}]"
