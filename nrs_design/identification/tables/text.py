"""The rows of a text file, block by block, so that the text is never in memory at once."""

from __future__ import annotations

import csv
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO, NoReturn

import numpy as np

from nrs_design.errors import DataError
from nrs_design.identification.numeric import Array
from nrs_design.identification.tables.columns import Column
from nrs_design.identification.tables.header import BLOCK, Header, is_decimal
from nrs_design.proof.text import quoted

MAX_ROWS = 10_000_000
MAX_LABELS = 1000
_UNDECIDED = "save it with a decimal point and without marks between thousands"


def read_blocks(
    file: BinaryIO, path: Path, first: bytes, seen: Callable[[bytes], None]
) -> Iterator[bytes]:
    """Yield blocks of whole lines."""
    rest = first
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


@dataclass(slots=True)
class Parser:
    """Turns blocks of lines into numbers."""

    path: Path  # For errors
    header: Header  # How the file is written
    columns: list[Column]  # Those that are needed, in the order of the file
    # Words of the column of modes, in the order in which they come; a number stands for each.
    labels: list[str] = field(default_factory=list)

    def parse(self, block: bytes, line: int) -> Array:
        """Read a block that begins at a line; find out what is wrong only if something is."""
        if self.header.quoted:
            block = self._tabbed(block)
        if self.header.decimal_comma:
            self._refuse_points(block, line)
            block = block.replace(b",", b".")
        lines = block.decode("utf-8", "replace").replace("\r\n", "\n").split("\n")
        while lines and not lines[-1].strip():
            lines.pop()
        if not lines:
            return np.empty((0, len(self.columns)))
        regular = self._is_regular(block, lines)
        try:
            values = self._load(lines)
        except ValueError:
            regular = False
        if not regular or len(values) != len(lines) or not np.isfinite(values).all():
            self._explain(lines, line)
        return values

    @property
    def _separator(self) -> str | None:
        """Tabs stand between cells that stood in quotes, and may hold commas."""
        return "\t" if self.header.quoted else self.header.separator

    def _tabbed(self, block: bytes) -> bytes:
        text = block.decode("utf-8", "replace").replace("\r\n", "\n")
        return "\n".join(map(self._without_quotes, text.split("\n"))).encode()

    def _without_quotes(self, line: str) -> str:
        try:
            cells = next(csv.reader([line], delimiter=str(self.header.separator)), [])
        except csv.Error:
            return line
        return "\t".join(cells)

    def _load(self, lines: list[str]) -> Array:
        used = [column.index for column in self.columns]
        words: dict[int | str, Callable[[str], float]] = {
            column.index: self._label for column in self.columns if column.unit == ""
        }
        with warnings.catch_warnings():
            # Callers that need rows report that there are none.
            warnings.simplefilter("ignore")
            values = np.loadtxt(
                lines,
                delimiter=self._separator,
                usecols=used,
                ndmin=2,
                comments=None,
                converters=words or None,
            )
        return np.asarray(values, float)

    def _label(self, word: str) -> float:
        word = word.strip().strip('"')
        if word not in self.labels:
            if not word or len(self.labels) >= MAX_LABELS:
                raise ValueError
            self.labels.append(word)
        return float(self.labels.index(word))

    def _is_regular(self, block: bytes, lines: list[str]) -> bool:
        width, separator = len(self.header.names), self._separator
        if separator is None:
            return all(len(line.split()) == width for line in lines)
        return block.count(separator.encode()) == len(lines) * (width - 1) and all(lines)

    def _refuse_points(self, block: bytes, line: int) -> None:
        """Refuse a point beside decimal commas: it may stand between thousands."""
        if b"." not in block:
            return
        for number, text in enumerate(block.decode("utf-8", "replace").split("\n"), start=line):
            cells = dict(enumerate(text.split(self._separator)))
            for column in self.columns:
                cell = cells.get(column.index, "").strip()
                if "." in cell and is_decimal(cell):
                    fault = f"{column.name} is {cell} where others have a decimal comma"
                    self._fail(fault, number, _UNDECIDED)

    def _explain(self, lines: list[str], line: int) -> NoReturn:
        width, separator = len(self.header.names), self._separator
        for number, text in enumerate(lines, start=line):
            cells = text.split(separator)
            if not text.strip():
                self._fail("the row is empty", number, "remove it")
            if len(cells) != width:
                doubled = separator == "," and len(cells) > width
                self._fail(
                    f"the row has {len(cells)} values, the header {width}",
                    number,
                    "write numbers with a decimal point, or separate them by semicolons"
                    if doubled
                    else "complete the row, or end the record before it",
                )
            for column in self.columns:
                self._check(cells[column.index].strip(), column, number)
        raise DataError("cannot be read", path=self.path, line=line, remedy="save it as plain CSV")

    def _check(self, cell: str, column: Column, line: int) -> None:
        name = column.name
        if not cell:
            self._fail(f"{name} is missing", line, "end the record before it, or fill the gap")
        if column.unit == "":
            return
        if not is_decimal(cell):
            thousands = "," in cell and is_decimal(cell.replace(",", ""))
            remedy = _UNDECIDED if thousands else "write decimal numbers"
            self._fail(f"{name} is {quoted(cell)}, not a number", line, remedy)
        if not np.isfinite(float(cell)):
            self._fail(
                f"{name} is {cell[:30]}", line, "cut the record so that all values are finite"
            )

    def _fail(self, message: str, line: int, remedy: str) -> NoReturn:
        raise DataError(message, path=self.path, line=line, remedy=remedy)
