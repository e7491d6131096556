"""Reading the columns of a text file."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO, NoReturn

import numpy as np

from nrs_design.errors import DataError
from nrs_design.files import open_regular
from nrs_design.identification.numeric import Array
from nrs_design.identification.tables.columns import Column, find_columns
from nrs_design.identification.tables.header import read_header
from nrs_design.identification.tables.kind import check_kind
from nrs_design.identification.tables.names import UNITS, standard_name
from nrs_design.identification.tables.text import MAX_ROWS, Parser, read_blocks
from nrs_design.spec.quantity import LARGEST

Progress = Callable[[float], None]


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
    groups: dict[str, dict[str, Array]]  # Values by group and quantity, shape (n,) each
    columns: dict[str, dict[str, Column]]  # Where they come from, and their units
    labels: tuple[str, ...]  # Words of the column of modes; its values are their indices
    first_line: int  # Line of the first row, for messages

    def fail(self, message: str, row: int, remedy: str) -> NoReturn:
        """Raise an error about a row, counted from 0."""
        line = self.first_line + row
        raise DataError(message, path=self.source.path, line=line, remedy=remedy)


@dataclass(frozen=True, slots=True)
class Wanted:
    """What is looked for in a file."""

    # Quantities that belong together, see `names.UNITS`; the first that is there is taken.
    layouts: Sequence[tuple[str, ...]]
    mapping: Mapping[str, str]  # From a name in the file to ours
    optional: tuple[str, ...] = ()  # Quantities that are taken where they are there


def read_table(
    path: Path,
    layouts: Sequence[tuple[str, ...]],
    mapping: Mapping[str, str],
    progress: Progress = lambda fraction: None,
    optional: tuple[str, ...] = (),
) -> MeasurementTable:
    """Read the columns of one of several layouts from a text with a line of names."""
    wanted = Wanted(layouts, mapping, optional)
    try:
        size = max(path.stat().st_size, 1)
        if path.is_dir():
            raise DataError("is a folder", path=path, remedy="name files of data")
        with open_regular(path) as file:
            check_kind(file, path)
            table = _read(file, path, wanted, lambda done: progress(min(done / size, 1.0)))
    except OSError as error:
        raise DataError(
            f"cannot be read ({error.strerror})", path=path, remedy="check the name"
        ) from error
    _check_sizes(table)
    return table


def _check_sizes(table: MeasurementTable) -> None:
    """Refuse values whose squares, or the squares of those, leave the floats."""
    for group, columns in table.groups.items():
        for quantity, values in columns.items():
            column = table.columns[group][quantity]
            bad = np.flatnonzero(np.abs(values) > LARGEST)
            if len(bad):
                size = f"{values[bad[0]] / column.factor:.4g}"
                message = f"{column.name} is {size}: no sensor has such a value"
                table.fail(message, int(bad[0]), "cut the record before it, or correct the value")


def _read(file: BinaryIO, path: Path, wanted: Wanted, progress: Progress) -> MeasurementTable:
    hashed = hashlib.sha256()
    example = ",".join(
        key if "any" in UNITS[key] else standard_name(key) for key in wanted.layouts[0]
    )
    header = read_header(file, path, wanted.mapping, hashed.update, example)
    layout, groups = find_columns(
        header.names, wanted.layouts, wanted.mapping, path, header.line, wanted.optional
    )
    columns = sorted({column for group in groups.values() for column in group.values()},
                     key=lambda column: column.index)  # fmt: skip
    parser = Parser(path, header, columns)
    parts: list[Array] = []
    rows = 0
    for block in read_blocks(file, path, header.rest, hashed.update):
        parts.append(parser.parse(block, header.line + 1 + rows))
        rows += len(parts[-1])
        progress(float(file.tell()))
        if rows > MAX_ROWS:
            raise _too_long(path)
    values = np.concatenate(parts) if parts else np.empty((0, len(columns)))
    at = {column: i for i, column in enumerate(columns)}
    data = {
        name: {key: _in_si(values[:, at[column]], column) for key, column in group.items()}
        for name, group in groups.items()
    }
    progress(float(path.stat().st_size))
    source = Source(path, hashed.hexdigest(), header.synthetic)
    return MeasurementTable(source, layout, data, groups, tuple(parser.labels), header.line + 1)


def _in_si(values: Array, column: Column) -> Array:
    """Convert a column; what leaves the floats by that is refused with the other sizes."""
    with np.errstate(over="ignore"):
        return np.asarray(values * column.factor)


def _too_long(path: Path) -> DataError:
    return DataError(f"has more than {MAX_ROWS} rows", path=path, remedy="record at a lower rate")
