"""Reading numbers from a CSV file, block by block, so that the text is never in memory at once."""

from __future__ import annotations

import csv
import hashlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO, NoReturn

import numpy as np
from numpy.typing import NDArray

from nrs_design.errors import DataError
from nrs_design.files import open_regular
from nrs_design.identification.datasets.columns import Column, find_columns
from nrs_design.proof.text import quoted

Array = NDArray[np.float64]
Progress = Callable[[float], None]

BLOCK = 1 << 20
MAX_COLUMNS = 1000
MAX_NAME = 100
MAX_ROWS = 10_000_000
MAX_PREAMBLE = 100
SYNTHETIC = "synthetic"


@dataclass(frozen=True, slots=True)
class Source:
    """Where data come from.

    Parameters
    ----------
    path : Path
        The file, as it was named.
    sha256 : str
        Hash of its bytes, in hexadecimal.
    synthetic : bool
        Whether the comments at its top say that the record is synthetic, not measured.
    """

    path: Path
    sha256: str
    synthetic: bool


@dataclass(frozen=True, slots=True, eq=False)
class Table:
    """The columns of one file, in SI.

    Parameters
    ----------
    source : Source
        The file.
    layout : tuple of str
        Quantities that were found.
    groups : dict of str to dict of str to ndarray
        Values by group and quantity, shape (n,) each.
    first_line : int
        Line of the first row, for messages.
    """

    source: Source
    layout: tuple[str, ...]
    groups: dict[str, dict[str, Array]]
    first_line: int

    def fail(self, message: str, row: int, remedy: str) -> NoReturn:
        """Raise an error about a row, counted from 0.

        Parameters
        ----------
        message : str
            What is wrong.
        row : int
            Counted from 0.
        remedy : str
            What to do about it.
        """
        raise DataError(message, path=self.source.path, line=self.first_line + row, remedy=remedy)


@dataclass(frozen=True, slots=True)
class _Header:
    names: list[str]
    line: int
    synthetic: bool


def read_table(
    path: Path,
    layouts: Sequence[tuple[str, ...]],
    mapping: Mapping[str, str],
    progress: Progress = lambda fraction: None,
) -> Table:
    """Read the columns of one of several layouts.

    Parameters
    ----------
    path : Path
        A CSV file: comments (``# ...``), one header line, rows of numbers.
    layouts : sequence of tuple of str
        Quantities that belong together, see `columns.UNITS`.
    mapping : mapping of str to str
        From a name in the file to ours.
    progress : callable
        Told the fraction that has been read.

    Raises
    ------
    DataError
        With the line, if the file cannot be read, a column is missing, or a value is no number.
    """
    try:
        size = max(path.stat().st_size, 1)
        if path.is_dir():
            raise DataError("is a folder", path=path, remedy="name CSV files")
        with open_regular(path) as file:
            return _read(file, path, layouts, mapping, lambda done: progress(done / size))
    except OSError as error:
        raise DataError(
            f"cannot be read ({error.strerror})", path=path, remedy="check the name"
        ) from error


def _read(
    file: BinaryIO,
    path: Path,
    layouts: Sequence[tuple[str, ...]],
    mapping: Mapping[str, str],
    progress: Progress,
) -> Table:
    digest = hashlib.sha256()
    header = _read_header(file, path, digest.update)
    layout, groups = find_columns(header.names, layouts, mapping, path, header.line)
    columns = sorted({column for group in groups.values() for column in group.values()},
                     key=lambda column: column.index)  # fmt: skip
    parser = _Parser(path, header, columns)
    parts: list[Array] = []
    rows = 0
    for block in _blocks(file, path, digest.update):
        parts.append(parser.parse(block, header.line + 1 + rows))
        rows += len(parts[-1])
        progress(float(file.tell()))
        if rows > MAX_ROWS:
            raise DataError(
                f"has more than {MAX_ROWS} rows", path=path, remedy="record at a lower rate"
            )
    values = np.concatenate(parts) if parts else np.empty((0, len(columns)))
    at = {column: i for i, column in enumerate(columns)}
    data = {
        name: {key: values[:, at[column]] * column.factor for key, column in group.items()}
        for name, group in groups.items()
    }
    source = Source(path, digest.hexdigest(), header.synthetic)
    return Table(source, layout, data, header.line + 1)


def _read_header(file: BinaryIO, path: Path, seen: Callable[[bytes], None]) -> _Header:
    synthetic = False
    for line in range(1, MAX_PREAMBLE + 1):
        raw = file.readline(BLOCK)
        seen(raw)
        try:
            text = raw.decode("utf-8-sig" if line == 1 else "utf-8").strip()
        except UnicodeDecodeError:
            raise DataError(
                "is no UTF-8 text", path=path, line=line, remedy="save it as CSV in UTF-8"
            ) from None
        if not raw:
            break
        if text.startswith("#"):
            synthetic = synthetic or SYNTHETIC in text.lower()
        elif text:
            return _Header(_names(text, path, line), line, synthetic)
    raise DataError("has no header line", path=path, remedy="name the columns in the first line")


def _names(text: str, path: Path, line: int) -> list[str]:
    if text.count(",") >= MAX_COLUMNS or max(map(len, text.split(","))) > MAX_NAME:
        raise DataError(
            f"has more than {MAX_COLUMNS} columns, or one with a name of over {MAX_NAME} letters",
            path=path,
            line=line,
            remedy="save the columns that are needed, under short names",
        )
    try:
        names = [name.strip() for name in next(csv.reader([text]))]
    except csv.Error as error:
        raise DataError(
            f"has a header line that is no CSV ({error})",
            path=path,
            line=line,
            remedy="save it with one header line and line ends of one kind",
        ) from None
    if len(names) == 1:
        for separator, word in ((";", "semicolons"), ("\t", "tabs")):
            if separator in text:
                raise DataError(
                    f"its columns are separated by {word}",
                    path=path,
                    line=line,
                    remedy="save it with commas, and numbers with a decimal point",
                )
    if all(_is_number(name) for name in names):
        raise DataError(
            "begins with numbers, not with the names of its columns",
            path=path,
            line=line,
            remedy="add a header such as time_s,deflection_m,force_N",
        )
    return names


def _blocks(file: BinaryIO, path: Path, seen: Callable[[bytes], None]) -> Iterator[bytes]:
    """Yield blocks of whole lines."""
    rest = b""
    while chunk := file.read(BLOCK):
        seen(chunk)
        body, newline, tail = chunk.rpartition(b"\n")
        if newline:
            yield rest + body + newline
            rest = tail
        elif len(rest) > BLOCK:
            raise DataError("has a line of over 1 MiB", path=path, remedy="save it as CSV")
        else:
            rest += chunk
    if rest.strip():
        yield rest


@dataclass(frozen=True, slots=True)
class _Parser:
    path: Path
    header: _Header
    columns: list[Column]

    def parse(self, block: bytes, line: int) -> Array:
        """Read a block that begins at a line; find out what is wrong only if something is."""
        lines = block.decode("ascii", "replace").replace("\r\n", "\n").split("\n")
        while lines and not lines[-1].strip():
            lines.pop()
        if not lines:
            return np.empty((0, len(self.columns)))
        width = len(self.header.names)
        regular = block.count(b",") == len(lines) * (width - 1) and all(lines)
        used = [column.index for column in self.columns]
        try:
            values = np.loadtxt(lines, delimiter=",", usecols=used, ndmin=2, comments=None)
        except ValueError:
            regular = False
        if not regular or len(values) != len(lines) or not np.isfinite(values).all():
            self._explain(lines, line)
        return np.asarray(values, float)

    def _explain(self, lines: list[str], line: int) -> NoReturn:
        width = len(self.header.names)
        for number, text in enumerate(lines, start=line):
            cells = text.split(",")
            if not text.strip():
                self._fail("the row is empty", number, "remove it")
            if len(cells) != width:
                self._fail(
                    f"the row has {len(cells)} values, the header {width}",
                    number,
                    "complete the row, or end the record before it",
                )
            for column in self.columns:
                self._check(cells[column.index].strip(), column.name, number)
        raise DataError("cannot be read", path=self.path, line=line, remedy="save it as plain CSV")

    def _check(self, cell: str, name: str, line: int) -> None:
        if not cell:
            self._fail(f"{name} is missing", line, "end the record before it, or fill the gap")
        if not _is_number(cell):
            self._fail(f"{name} is {quoted(cell)}, not a number", line, "write decimal numbers")
        if not np.isfinite(float(cell)):
            self._fail(
                f"{name} is {cell[:30]}", line, "cut the record so that all values are finite"
            )

    def _fail(self, message: str, line: int, remedy: str) -> NoReturn:
        raise DataError(message, path=self.path, line=line, remedy=remedy)


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return "_" not in text and text.isascii()
