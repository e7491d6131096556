"""Reading the columns of a text file, or of arrays."""

from __future__ import annotations

import hashlib
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path
from typing import Any, BinaryIO, NoReturn

import numpy as np

from nrs_design.errors import DataError
from nrs_design.files import open_regular
from nrs_design.identification.numeric import Array
from nrs_design.identification.tables.columns import Column, find_columns
from nrs_design.identification.tables.header import UNDECIDED, Header, is_decimal, read_header
from nrs_design.identification.tables.names import UNITS, standard_name
from nrs_design.proof.text import quoted
from nrs_design.spec.quantity import LARGEST

# A file, or arrays by the names of their columns, such as a DataFrame.
Data = Path | Mapping[str, Any]

MAX_ROWS = 10_000_000
MAX_LABELS = 1000
_LONGEST_LINE = 1 << 20
_PREAMBLE = 100
_IN_MEMORY = Path("arrays")


@dataclass(frozen=True, slots=True)
class Source:
    """Where data come from."""

    path: Path  # The file, as it was named
    sha256: str  # Hash of its bytes, in hexadecimal
    # Whether the comments at its top say that the record is synthetic, not measured.
    synthetic: bool


@dataclass(frozen=True, slots=True, eq=False)
class MeasurementTable:
    """The columns of one file, in SI."""

    source: Source  # The file
    layout: tuple[str, ...]  # Quantities that were found
    values: dict[str, Array]  # By quantity, shape (n,) each
    columns: dict[str, Column]  # Where they come from, and their units
    labels: tuple[str, ...]  # Words of the column of modes; its values are their indices
    first_line: int  # Line of the first row, for messages

    def fail(self, message: str, row: int, remedy: str) -> NoReturn:
        """Raise an error about a row, counted from 0."""
        line = self.first_line + row
        raise DataError(message, path=self.source.path, line=line, remedy=remedy)


def read_table(
    data: Data,
    layouts: Sequence[tuple[str, ...]],
    mapping: Mapping[str, str],
    optional: tuple[str, ...] = (),
) -> MeasurementTable:
    """Read the columns of one of several layouts from a text with a line of names, or from arrays.

    A layout is of quantities that belong together, see `names.UNITS`; a mapping leads from a name
    in the file to ours; optional quantities are taken where they are there.
    """
    if not isinstance(data, Path):
        table = _read_arrays(data, layouts, mapping, optional)
    else:
        try:
            if data.is_dir():
                raise DataError("is a folder", path=data, remedy="name files of data")
            with open_regular(data) as file:
                table = _read(file, data, layouts, mapping, optional)
        except OSError as error:
            raise DataError(
                f"cannot be read ({error.strerror})", path=data, remedy="check the name"
            ) from error
    _check_sizes(table)
    return table


def _check_sizes(table: MeasurementTable) -> None:
    """Refuse values that are not finite, or whose squares, or their squares, leave the floats."""
    for quantity, values in table.values.items():
        column = table.columns[quantity]
        bad = np.flatnonzero(~(np.abs(values) <= LARGEST))
        if len(bad):
            size = f"{column.name} is {values[bad[0]] / column.factor:.4g}"
            message = f"{size}: no sensor has such a value"
            table.fail(message, int(bad[0]), "cut the record before it, or correct the value")


def _read_arrays(
    data: Mapping[str, Any],
    layouts: Sequence[tuple[str, ...]],
    mapping: Mapping[str, str],
    optional: tuple[str, ...],
) -> MeasurementTable:
    given = {str(name): np.asarray(data[name]) for name in data.keys()}  # noqa: SIM118
    layout, columns = find_columns([*given], layouts, mapping, _IN_MEMORY, None, optional)
    hashed, labels = hashlib.sha256(), _Labels()
    found: dict[str, Array] = {}
    for quantity, column in columns.items():
        values = given[column.name]
        if values.ndim != 1 or len(values) != len(next(iter(given.values()))):
            raise DataError(
                f"{column.name} is no column of one length", remedy="give arrays of shape (n,)"
            )
        try:
            numbers = values.astype(float)
        except ValueError:
            numbers = np.array([labels.number(str(word)) for word in values.tolist()])
        found[quantity] = numbers * column.factor
        hashed.update(column.name.encode() + numbers.tobytes())
    source = Source(_IN_MEMORY, hashed.hexdigest(), synthetic=False)
    return MeasurementTable(source, layout, found, columns, tuple(labels.words), 0)


@dataclass(slots=True)
class _Labels:
    """Words of a column of modes, in the order in which they come; a number stands for each."""

    words: list[str] = field(default_factory=list)

    def number(self, word: str) -> float:
        """Return the number of a word."""
        word = word.strip().strip('"')
        if word not in self.words:
            if not word or len(self.words) >= MAX_LABELS:
                raise ValueError
            self.words.append(word)
        return float(self.words.index(word))


def _read(
    file: BinaryIO,
    path: Path,
    layouts: Sequence[tuple[str, ...]],
    mapping: Mapping[str, str],
    optional: tuple[str, ...],
) -> MeasurementTable:
    hashed = hashlib.sha256()
    while block := file.read(_LONGEST_LINE):
        hashed.update(block)
    file.seek(0)
    lines = _lines(file, path)
    head = [line for _, line in zip(range(_PREAMBLE + 1), lines, strict=False)]
    example = ",".join(key if "any" in UNITS[key] else standard_name(key) for key in layouts[0])
    header = read_header(head, path, mapping, example)
    layout, columns = find_columns(header.names, layouts, mapping, path, header.line, optional)
    rows = _Rows(path, header, [*columns.values()])
    numbers = rows.load(chain(head[header.line :], lines))
    # What leaves the floats is refused with the other sizes.
    with np.errstate(over="ignore"):
        scaled = numbers.T * np.array([[column.factor] for column in columns.values()])
    values = dict(zip(columns, scaled, strict=True))
    source = Source(path, hashed.hexdigest(), header.synthetic)
    labels = tuple(rows.labels.words)
    return MeasurementTable(source, layout, values, columns, labels, header.line + 1)


def _lines(file: BinaryIO, path: Path) -> Iterator[str]:
    """Yield the lines of a text, so that it is never in memory at once."""
    number = 0
    while raw := file.readline(_LONGEST_LINE):
        number += 1
        if b"\0" in raw or (number == 1 and raw.startswith((b"%PDF", b"PK\3\4", b"\x1f\x8b"))):
            raise DataError(
                "is no text in UTF-8", path=path, line=number, remedy="save its columns as CSV"
            )
        if len(raw) == _LONGEST_LINE:
            raise DataError("has a line of over 1 MiB", path=path, remedy="save it as CSV")
        try:
            yield raw.decode("utf-8-sig" if number == 1 else "utf-8").strip("\r\n ")
        except UnicodeDecodeError:
            # Measuring software on Windows writes µ and ° in this way.
            yield raw.decode("cp1252", "replace").strip("\r\n ")


@dataclass(slots=True)
class _Rows:
    """Turns lines into numbers."""

    path: Path  # For errors
    header: Header  # How the file is written
    columns: list[Column]  # Those that are needed
    labels: _Labels = field(default_factory=_Labels)
    line: int = 0  # Which line was read last
    text: str = ""  # That line

    def load(self, lines: Iterator[str]) -> Array:
        """Return the numbers, shape (n, columns)."""
        words: Any = {c.index: self.labels.number for c in self.columns if c.unit == ""}
        with warnings.catch_warnings():
            # Callers that need rows report that there are none.
            warnings.simplefilter("ignore")
            try:
                values = np.loadtxt(
                    self._regular(lines),
                    delimiter="\t",
                    usecols=[column.index for column in self.columns],
                    ndmin=2,
                    comments=None,
                    converters=words or None,
                )
            except ValueError:
                self._explain()
        return np.asarray(values, float).reshape(-1, len(self.columns))

    def _regular(self, lines: Iterator[str]) -> Iterator[str]:
        """Yield lines with tabs between their cells; refuse one that is not as long as others."""
        width, separator = len(self.header.names), self.header.separator
        empty, self.line = 0, self.header.line
        for text in lines:
            self.line += 1
            if not text:
                empty = empty or self.line
                continue
            if empty:
                self._fail("the row is empty", empty, "remove it")
            if self.line - self.header.line > MAX_ROWS:
                raise DataError(
                    f"has more than {MAX_ROWS} rows", path=self.path, remedy="record more slowly"
                )
            cells = self.header.cells(text) if '"' in text else text.split(separator)
            if len(cells) != width:
                doubled = separator == "," and len(cells) > width
                self._fail(
                    f"the row has {len(cells)} values, the header {width}",
                    self.line,
                    "write numbers with a decimal point, or separate them by semicolons"
                    if doubled
                    else "complete the row, or end the record before it",
                )
            if self.header.decimal_comma:
                self._refuse_points(cells)
                cells = [cell.replace(",", ".") for cell in cells]
            self.text = "\t".join(cells)
            yield self.text

    def _refuse_points(self, cells: Sequence[str]) -> None:
        """Refuse a point beside decimal commas: it may stand between thousands."""
        for column in self.columns:
            cell = cells[column.index].strip()
            if "." in cell and is_decimal(cell):
                fault = f"{column.name} is {cell} where others have a decimal comma"
                self._fail(fault, self.line, UNDECIDED)

    def _explain(self) -> NoReturn:
        """Say what is wrong with the line that was read last."""
        cells = self.text.split("\t")
        for column in self.columns:
            name, cell = column.name, cells[column.index].strip()
            if not cell:
                remedy = "end the record before it, or fill the gap"
                self._fail(f"{name} is missing", self.line, remedy)
            if column.unit and not is_decimal(cell):
                thousands = "," in cell and is_decimal(cell.replace(",", ""))
                remedy = UNDECIDED if thousands else "write decimal numbers"
                self._fail(f"{name} is {quoted(cell)}, not a number", self.line, remedy)
        raise DataError(
            "cannot be read", path=self.path, line=self.line, remedy="save it as plain CSV"
        )

    def _fail(self, message: str, line: int, remedy: str) -> NoReturn:
        raise DataError(message, path=self.path, line=line, remedy=remedy)
