"""Records are text: what else a file may be is named by how it begins."""

from __future__ import annotations

from pathlib import Path
from typing import BinaryIO

from nrs_design.errors import DataError

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


def check_kind(file: BinaryIO, path: Path) -> None:
    """Refuse a file that is no text, whatever its name says; stay at its beginning."""
    start = file.read(32)
    file.seek(0)
    for begins, what, remedy in _BEGINNINGS:
        if start.startswith(begins):
            raise DataError(what, path=path, remedy=remedy)
