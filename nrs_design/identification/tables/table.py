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
from nrs_design.identification.tables.names import UNITS, standard_name
from nrs_design.identification.tables.text import MAX_ROWS, Parser, read_blocks
from nrs_design.spec.quantity import LARGEST

Progress = Callable[[float], None]

_AS_CSV = "save its columns as CSV"
# How files begin that are no text, and what to do with them.
_BEGINNINGS = (
    (b"MATLAB 5.0", "is a file of MATLAB", _AS_CSV),
    (b"MATLAB 7.3", "is a file of MATLAB (HDF5)", _AS_CSV),
    (b"\x89HDF", "is an HDF5 file", _AS_CSV),
    (b"PAR1", "is a Parquet file", _AS_CSV),
    (b"PK\x03\x04", "is a zip archive", f"unpack it; of Excel or NumPy, {_AS_CSV}"),
    (b"\xd0\xcf\x11\xe0", "is an old Excel file", _AS_CSV),
    (b"\x1f\x8b", "is compressed", "unpack it first"),
    (b"#ROSBAG", "is a bag of ROS messages", "turn its topics into CSV first"),
    (b"SQLite format 3", "is a database, or a bag of ROS messages", "turn it into CSV first"),
    (b"\x89MCAP0", "is a bag of ROS messages", "turn its topics into CSV first"),
    (b"TDSm", "is a TDMS file of LabVIEW", "export it as text"),
    (b"%PDF", "is a PDF", "name the file of data"),
)


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


def read_table(
    path: Path,
    layouts: Sequence[tuple[str, ...]],
    mapping: Mapping[str, str],
    progress: Progress = lambda fraction: None,
    optional: tuple[str, ...] = (),
) -> MeasurementTable:
    """Read the columns of one of several layouts from a text with a line of names.

    A layout is of quantities that belong together, see `names.UNITS`; a mapping leads from a name
    in the file to ours; optional quantities are taken where they are there.
    """
    try:
        size = max(path.stat().st_size, 1)
        if path.is_dir():
            raise DataError("is a folder", path=path, remedy="name files of data")
        with open_regular(path) as file:
            _check_kind(file, path)

            def part(done: float) -> None:
                progress(min(done / size, 1.0))

            table = _read(file, path, layouts, mapping, part, optional)
    except OSError as error:
        raise DataError(
            f"cannot be read ({error.strerror})", path=path, remedy="check the name"
        ) from error
    _check_sizes(table)
    return table


def _check_kind(file: BinaryIO, path: Path) -> None:
    """Refuse a file that is no text, whatever its name says; stay at its beginning."""
    start = file.read(32)
    file.seek(0)
    for begins, what, remedy in _BEGINNINGS:
        if start.startswith(begins):
            raise DataError(what, path=path, remedy=remedy)


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


def _read(
    file: BinaryIO,
    path: Path,
    layouts: Sequence[tuple[str, ...]],
    mapping: Mapping[str, str],
    progress: Progress,
    optional: tuple[str, ...],
) -> MeasurementTable:
    hashed = hashlib.sha256()
    example = ",".join(key if "any" in UNITS[key] else standard_name(key) for key in layouts[0])
    header = read_header(file, path, mapping, hashed.update, example)
    layout, groups = find_columns(header.names, layouts, mapping, path, header.line, optional)
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
            raise DataError(
                f"has more than {MAX_ROWS} rows", path=path, remedy="record at a lower rate"
            )
    values = np.concatenate(parts) if parts else np.empty((0, len(columns)))
    at = {column: i for i, column in enumerate(columns)}
    # What leaves the floats is refused with the other sizes.
    with np.errstate(over="ignore"):
        data = {
            name: {key: values[:, at[column]] * column.factor for key, column in group.items()}
            for name, group in groups.items()
        }
    progress(float(path.stat().st_size))
    source = Source(path, hashed.hexdigest(), header.synthetic)
    return MeasurementTable(source, layout, data, groups, tuple(parser.labels), header.line + 1)
