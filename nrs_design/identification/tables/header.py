"""Where the table of a text file begins, and how its cells are separated."""

from __future__ import annotations

import csv
import re
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import BinaryIO

from nrs_design.errors import DataError
from nrs_design.identification.tables.columns import check_stated
from nrs_design.identification.tables.names import (
    UNITS,
    read_name,
    read_stamp,
    read_unit,
    stated_unit,
)

BLOCK = 1 << 20
MAX_COLUMNS = 1000
MAX_NAME = 100
MAX_PREAMBLE = 100
SYNTHETIC = "synthetic"
# Blanks, None, come last: names may hold them.
SEPARATORS = (",", ";", "\t", None)
# What a line of units may be about.
_MEASURED = ("time", "deflection", "force", "angle", "torque", "velocity", "command")

_DECIMAL_COMMA = re.compile(r"^[+-]?\d+,\d+([eE][+-]?\d+)?$")
_THOUSANDS = re.compile(r"^[+-]?[1-9]\d{0,2}(,\d{3})+$")
_BRACKETS = re.compile(r"^[\[({](.*)[\])}]$")


@dataclass(frozen=True, slots=True)
class Header:
    """How a text file is to be read."""

    names: list[str]  # Of the columns, with the units of the next line where it has them
    separator: str | None  # Between cells; None for any number of blanks
    decimal_comma: bool  # Whether numbers have one
    quoted: bool  # Whether cells stand in quotes, which may hide separators
    line: int  # Last line above the rows
    synthetic: bool  # Whether a comment above says so
    rest: bytes  # What has been read beyond that line


def read_header(
    file: BinaryIO,
    path: Path,
    mapped: Mapping[str, str],
    seen: Callable[[bytes], None],
    example: str,
) -> Header:
    """Find the line of names: below a preamble, above the first row."""
    raw: list[bytes] = []
    while len(raw) <= MAX_PREAMBLE and sum(map(len, raw)) <= BLOCK:
        if not (line := file.readline(BLOCK)):
            break
        seen(line)
        raw.append(line)
    lines = [_decoded(line, path, number) for number, line in enumerate(raw, 1)]
    at, separator = _find(lines, mapped, path, example)
    names = _names(lines[at], separator, path, at + 1)
    below = _below_blanks(lines, at + 1)
    if below < len(lines):
        units = _cells(lines[below], separator)
        if _are_units(units, len(names)):
            pairs = list(zip(names, units, strict=True))
            _check_mapped_units(pairs, mapped, path)
            names = [_with_unit(name, unit, mapped) for name, unit in pairs]
            below = _below_blanks(lines, below + 1)
    comma = _has_decimal_comma(lines[below:], separator, path, below + 1)
    comments = [text.lower() for text in lines[:at] if text.startswith("#")]
    synthetic = any(SYNTHETIC in text for text in comments)
    quoted = separator is not None and any('"' in text for text in lines[below:])
    return Header(names, separator, comma, quoted, below, synthetic, b"".join(raw[below:]))


def is_decimal(text: str) -> bool:
    """Tell whether a cell is a decimal number."""
    try:
        float(text)
    except ValueError:
        return False
    return "_" not in text and text.isascii()


def _decoded(raw: bytes, path: Path, line: int) -> str:
    if b"\0" in raw:
        remedy = "save it as CSV in UTF-8"
        if raw.startswith((b"\xff\xfe", b"\xfe\xff")):
            raise DataError("is UTF-16 text, not UTF-8", path=path, line=line, remedy=remedy)
        raise DataError("is no text", path=path, line=line, remedy=remedy)
    try:
        return raw.decode("utf-8-sig" if line == 1 else "utf-8").strip("\r\n ")
    except UnicodeDecodeError:
        # Measuring software on Windows writes µ and ° in this way.
        return raw.decode("cp1252", "replace").strip("\r\n ")


def _find(
    lines: Sequence[str], mapped: Collection[str], path: Path, example: str
) -> tuple[int, str | None]:
    """Return the line with the most names that are known, or the one above the first numbers."""
    # Rows of numbers say what separates the cells; a name may hold blanks.
    separators = [s for text in lines if text and (s := _separator_of(text)) != ""][:1]
    scores = [
        (sum(_is_known(name, mapped) for name in _cells(text, separator)), -at, -rank)
        for at, text in enumerate(lines)
        for rank, separator in enumerate(SEPARATORS)
        if separator in (separators or SEPARATORS)
    ]
    best, at, rank = max(scores, default=(0, 0, 0))
    if best >= 2:
        return -at, SEPARATORS[-rank]
    last = None
    for at, text in enumerate(lines):
        if not text or text.startswith("#"):
            continue
        separator = _separator_of(text)
        if separator != "":
            if last is None:
                raise _nameless(path, at + 1, example)
            # This line may hold the units of the names above.
            units, names = _cells(lines[last], separator), _cells(lines[last - 1], separator)
            below = last > 0 and _are_units(units, len(names))
            return last - 1 if below else last, separator
        last = at
    if last is None:
        raise DataError("has no header line", path=path, remedy="name the columns in a line")
    first = next(i for i, text in enumerate(lines) if text and not text.startswith("#"))
    if is_decimal(lines[first]):
        raise _nameless(path, first + 1, example)
    return first, max(SEPARATORS[:3], key=lambda s: lines[first].count(s or ","))


def _nameless(path: Path, line: int, example: str) -> DataError:
    return DataError(
        "begins with numbers, not with the names of its columns",
        path=path,
        line=line,
        remedy=f"add a header such as {example}",
    )


def _below_blanks(lines: Sequence[str], at: int) -> int:
    """Return the first line that is not empty, if there is one: rows need not follow at once."""
    return next((i for i in range(at, len(lines)) if lines[i]), at)


def _separator_of(text: str) -> str | None:
    """Return what separates numbers in a line; empty if they are none."""
    for separator in (";", "\t", ",", None):
        cells = _cells(text, separator)
        comma = separator != "," or '"' in text
        if (
            len(cells) > 1
            and any(cells)
            and all(
                is_decimal(cell) or (comma and _DECIMAL_COMMA.match(cell)) for cell in cells if cell
            )
        ):
            return separator
    return ""


def _is_known(name: str, mapped: Collection[str]) -> bool:
    if name in mapped or read_stamp(name):
        return True
    found = read_name(name)
    return found is not None and (found.known or not found.unit)


def _cells(text: str, separator: str | None) -> list[str]:
    """Split a line; one that hides its names behind a comment sign is a header all the same."""
    text = text.removeprefix("#").strip(" ")
    # The first name of a bag begins with this sign.
    if not text.startswith("%time"):
        text = text.removeprefix("%").lstrip(" ")
    if '"' in text and separator is not None:
        try:
            return [cell.strip() for cell in next(csv.reader([text], delimiter=separator))]
        except csv.Error:
            return []
    return [cell.strip() for cell in text.split(separator)]


def _names(text: str, separator: str | None, path: Path, line: int) -> list[str]:
    if "\r" in text:
        raise DataError(
            "has a header line that is no CSV: a line end stands within it",
            path=path,
            line=line,
            remedy="save it with one header line and line ends of one kind",
        )
    names = _cells(text, separator)
    if len(names) > MAX_COLUMNS or max(map(len, names), default=0) > MAX_NAME:
        raise DataError(
            f"has more than {MAX_COLUMNS} columns, or one with a name of over {MAX_NAME} letters",
            path=path,
            line=line,
            remedy="save the columns that are needed, under short names",
        )
    return names


def _are_units(cells: Sequence[str], width: int) -> bool:
    """Tell whether a line below the names holds their units, such as ``(s);(mm);(N)``."""
    if len(cells) != width or not any(cells) or any(is_decimal(cell) for cell in cells):
        return False
    return all(
        not cell or _BRACKETS.match(cell) or any(read_unit(cell, q) in UNITS[q] for q in _MEASURED)
        for cell in cells
    )


def _with_unit(name: str, unit: str, mapped: Collection[str]) -> str:
    found = read_name(name)
    if not unit or name in mapped or (found is not None and found.known):
        return name
    match = _BRACKETS.match(unit)
    return f"{name} [{match[1] if match else unit}]"


def _check_mapped_units(
    pairs: Sequence[tuple[str, str]], mapped: Mapping[str, str], path: Path
) -> None:
    """Check mapped columns against the line of units below the names."""
    for theirs, unit in pairs:
        ours = read_name(mapped.get(theirs, ""))
        if ours is not None:
            bare = _BRACKETS.match(unit)
            said = stated_unit(f"column [{bare[1] if bare else unit}]", ours.quantity)
            check_stated(theirs, said, mapped[theirs], partial(DataError, path=path))


def _has_decimal_comma(lines: Sequence[str], separator: str | None, path: Path, line: int) -> bool:
    cells = [cell for text in lines for cell in _cells(text, separator)]
    commas = [cell for cell in cells if "," in cell]
    if commas and all(_THOUSANDS.match(cell) for cell in commas):
        raise DataError(
            f"{commas[0]!r} may be {commas[0].replace(',', '.')} or {commas[0].replace(',', '')}",
            path=path,
            line=line,
            remedy="save it with a decimal point and without marks between thousands",
        )
    return any(_DECIMAL_COMMA.match(cell) for cell in commas)
