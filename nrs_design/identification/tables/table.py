"""Reading the columns of a text file, or of arrays."""

from __future__ import annotations

import csv
import hashlib
from array import array
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from io import StringIO
from itertools import chain, islice
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from nrs_design.files import open_regular
from nrs_design.identification.errors import DataError
from nrs_design.identification.numeric import Array
from nrs_design.identification.tables.columns import UNITS, Column, find_columns, standard_name
from nrs_design.proof.text import quoted
from nrs_design.spec.quantity import LARGEST

# A file, or arrays by the names of their columns, such as a DataFrame.
Data = Path | Mapping[str, Any]
Layouts = Sequence[tuple[str, ...]]  # Quantities that belong together

MAX_ROWS = 10_000_000
MAX_LABELS = 1000
_LARGEST_FILE = 1 << 29
_PREAMBLE = 100
_ARRAYS = Path("arrays")
# Signs that a comment begins with.
_COMMENT = "#%"


@dataclass(frozen=True, slots=True)
class Source:
    """Where data come from."""

    path: Path  # The file, as the user named it
    sha256: str  # Hash of its bytes, in hexadecimal
    # True if a comment in the first lines contains "synthetic".
    synthetic: bool


@dataclass(frozen=True, slots=True, eq=False)
class MeasurementTable:
    """The columns of one file, in SI."""

    source: Source  # The file
    layout: tuple[str, ...]  # Quantities that were found
    values: dict[str, Array]  # By quantity, shape (n,) each
    columns: dict[str, Column]  # Their columns in the file
    labels: tuple[str, ...]  # Names of modes; the values of the mode column are their indices
    first_line: int  # Line of the first row, for messages

    def fail(self, message: str, row: int, remedy: str) -> NoReturn:
        """Raise an error about a row, counted from 0."""
        line = self.first_line + row
        raise DataError(message, path=self.source.path, line=line, remedy=remedy)


def read_table(
    data: Data, layouts: Layouts, mapping: Mapping[str, str], optional: tuple[str, ...] = ()
) -> MeasurementTable:
    """Read the columns of one of several layouts from a text with a line of names, or from arrays.

    A layout is of quantities that belong together, see `columns.UNITS`; a mapping leads from a name
    in the file to ours; optional quantities are taken where they are there.
    """
    read = _read if isinstance(data, Path) else _read_arrays
    try:
        table = read(data, layouts, mapping, optional)
    except DataError as error:
        error.path = data if isinstance(data, Path) else _ARRAYS
        raise
    # Refuse NaN, infinity, and values whose fourth power overflows.
    for quantity, values in table.values.items():
        column = table.columns[quantity]
        bad = np.flatnonzero(~(np.abs(values) <= LARGEST))
        if len(bad):
            size = f"{column.name} is {values[bad[0]] / column.factor:.4g}"
            message = f"{size}: no sensor measures this value"
            table.fail(message, int(bad[0]), "cut the record before it, or correct the value")
    return table


def _read_arrays(
    data: Any, layouts: Layouts, mapping: Mapping[str, str], optional: tuple[str, ...]
) -> MeasurementTable:
    arrays = {str(name): np.asarray(data[name]) for name in data.keys()}  # noqa: SIM118
    layout, columns = find_columns([*arrays], layouts, mapping, optional)
    hashed, cells = hashlib.sha256(), _Cells()
    values: dict[str, Array] = {}
    for quantity, column in columns.items():
        raw = arrays[column.name]
        if raw.ndim != 1 or len(raw) != len(next(iter(arrays.values()))):
            message = f"{column.name} is no column of one length"
            raise DataError(message, remedy="give arrays of shape (n,)")
        try:
            numbers = raw.astype(float)
        except ValueError:
            words = enumerate(map(str, raw.tolist()))
            numbers = np.array([cells.number(column, word, row) for row, word in words])
        values[quantity] = numbers * column.factor
        hashed.update(column.name.encode() + numbers.tobytes())
    source = Source(_ARRAYS, hashed.hexdigest(), synthetic=False)
    return MeasurementTable(source, layout, values, columns, tuple(cells.labels), 0)


def _read(
    path: Any, layouts: Layouts, mapping: Mapping[str, str], optional: tuple[str, ...]
) -> MeasurementTable:
    raw = _read_bytes(path)
    lines = _lines(raw)
    head = list(islice(lines, _PREAMBLE))
    example = ",".join(key if "any" in UNITS[key] else standard_name(key) for key in layouts[0])
    header_row, separator, names = _read_header(head, example)
    try:
        layout, columns = find_columns(names, layouts, mapping, optional)
    except DataError as error:
        error.line = header_row
        raise
    cells, numbers = _Cells(), array("d")
    for line, text in _filled(enumerate(chain(head[header_row:], lines), header_row + 1)):
        if line - header_row > MAX_ROWS:
            raise DataError(f"has more than {MAX_ROWS} rows", remedy="record more slowly")
        row = _parse_row(text, separator, line)
        if len(row) != len(names):
            raise DataError(
                f"the row has {len(row)} values, the header {len(names)}",
                line=line,
                remedy="complete the row; write numbers with a decimal point, not a comma",
            )
        numbers.extend([cells.number(c, row[c.index], line) for c in columns.values()])
    factors = np.array([column.factor for column in columns.values()])
    # Values beyond the floats are refused with the other sizes.
    with np.errstate(over="ignore"):
        scaled = np.reshape(numbers, (-1, len(columns))).T * factors[:, None]
    synthetic = any(text[:1] in _COMMENT and "synthetic" in text.lower() for text in head)
    source = Source(path, hashlib.sha256(raw).hexdigest(), synthetic)
    values = dict(zip(columns, scaled, strict=True))
    return MeasurementTable(source, layout, values, columns, tuple(cells.labels), header_row + 1)


def _read_header(lines: Sequence[str], example: str) -> tuple[int, str, list[str]]:
    """Return line, separator and names of the columns; the separator is a blank for any number.

    They are in the first line that is no comment, or in the comment right above bare numbers.
    """
    header = next((row for row, text in enumerate(lines) if text and text[0] not in _COMMENT), None)
    if header is None:
        raise DataError("has no header line", remedy="name the columns in a line")
    if _decimal(_parse_row(lines[header], _separator(lines[header]), header + 1)[0]) is not None:
        if header == 0 or not lines[header - 1]:
            raise DataError(
                "begins with numbers, not with the names of its columns",
                line=header + 1,
                remedy=f"add a header such as {example}",
            )
        header -= 1
    text = lines[header].lstrip(f"{_COMMENT} ")
    return header + 1, _separator(text), _parse_row(text, _separator(text), header + 1)


def _separator(text: str) -> str:
    """Return the most frequent separator of a line; blanks, which names may hold, come last."""
    return max(",;\t", key=text.count) if set(text) & set(",;\t") else " "


def _parse_row(text: str, separator: str, line: int) -> list[str]:
    try:
        row = next(csv.reader([text], delimiter=separator, skipinitialspace=True), [""])
    except csv.Error as error:
        message = f"the line is no CSV ({error})"
        raise DataError(message, line=line, remedy="save the file as CSV") from None
    return [cell.strip() for cell in row]


def _decimal(text: str) -> float | None:
    """Return the number that a cell is; None for other text, such as ``1_0``."""
    try:
        return float(text) if "_" not in text and text.isascii() else None
    except ValueError:
        return None


def _read_bytes(path: Path) -> bytes:
    if path.is_dir():
        raise DataError("is a folder", remedy="name files of data")
    try:
        with open_regular(path) as file:
            raw = file.read(_LARGEST_FILE + 1)
    except OSError as error:
        message = f"cannot be read ({error.strerror})"
        raise DataError(message, remedy="check the name") from error
    if len(raw) > _LARGEST_FILE:
        raise DataError("is larger than 512 MiB", remedy="record more slowly")
    return raw


def _lines(raw: bytes) -> Iterator[str]:
    """Yield the lines of a text."""
    if b"\0" in raw:
        line = raw.count(b"\n", 0, raw.index(b"\0")) + 1
        raise DataError("is no text in UTF-8", line=line, remedy="save its columns as CSV")
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        # Measuring software on Windows writes µ and ° in this way.
        text = raw.decode("cp1252", "replace")
    return (line.strip("\r\n ") for line in StringIO(text))


def _filled(lines: Iterable[tuple[int, str]]) -> Iterator[tuple[int, str]]:
    """Yield the lines with a row; empty ones may be at the end only."""
    empty = 0
    for line, text in lines:
        if not text:
            empty = empty or line
        elif empty:
            raise DataError("the row is empty", line=empty, remedy="remove it")
        else:
            yield line, text


@dataclass(slots=True)
class _Cells:
    """Turns cells into numbers."""

    # Index of each mode name, in the order of first use.
    labels: dict[str, float] = field(default_factory=dict)

    def number(self, column: Column, cell: str, line: int) -> float:
        """Return the number in a cell, or that of its word in a column of modes."""
        if column.unit and (number := _decimal(cell)) is not None:
            return number
        word = cell.strip(' "')
        if column.unit == "" and word and (word in self.labels or len(self.labels) < MAX_LABELS):
            return self.labels.setdefault(word, float(len(self.labels)))
        fault, remedy = f"is {quoted(cell)}, not a number", "write it with a decimal point"
        if not word:
            fault, remedy = "is missing", "end the record before it, or fill the gap"
        elif column.unit == "":
            fault, remedy = f"has more than {MAX_LABELS} words", "map another column"
        raise DataError(f"{column.name} {fault}", line=line, remedy=remedy)
