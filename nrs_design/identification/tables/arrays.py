"""Files that hold arrays, not text: MATLAB, NumPy, Parquet, Excel.

`read_arrays` and `read_sheet` have them read in a process of its own, `nrs_design.confined`, by the
function of their ending.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import BinaryIO

from nrs_design.confined import read_confined
from nrs_design.errors import DataError
from nrs_design.identification.foreign import (
    Content,
    read_mat,
    read_npz,
    read_parquet,
    unpack_sheet,
)

# How files begin that are often named for what they are not, and what to do with them.
_BEGINNINGS = (
    (b"\x89HDF", "is an HDF5 file (MATLAB's -v7.3?)", "save it with save(..., '-v7'), or as CSV"),
    (b"\x1f\x8b", "is compressed", "unpack it first"),
    (b"#ROSBAG", "is a bag of ROS messages", "turn its topics into CSV first"),
    (b"SQLite format 3", "is a database, or a bag of ROS messages", "turn it into CSV first"),
    (b"\x89MCAP0", "is a bag of ROS messages", "turn its topics into CSV first"),
    (b"\xd0\xcf\x11\xe0", "is an old Excel file", "save it as .xlsx or as CSV"),
    (b"TDSm", "is a TDMS file of LabVIEW", "export it as text"),
    (b"%PDF", "is a PDF", "name the file of data"),
    (b"PK\x03\x04", "is a zip archive", "name it .xlsx or .npz if it is one, or unpack it"),
    (b"PAR1", "is a Parquet file", "name it .parquet"),
    (b"MATLAB 5.0", "is a file of MATLAB", "name it .mat"),
)
_MATLAB_HDF = b"MATLAB 7.3"


def check_kind(file: BinaryIO, path: Path) -> None:
    """Refuse a file that is not what its name says; stay at its beginning."""
    start = file.read(32)
    file.seek(0)
    kind = path.suffix.lower()
    own = {".xlsx": b"PK", ".npz": b"PK", ".parquet": b"PAR1", ".mat": b"MATLAB 5.0"}.get(kind, b"")
    if start.startswith(_MATLAB_HDF):
        start = b"\x89HDF"
    if own and start.startswith(own):
        return
    for begins, what, remedy in _BEGINNINGS:
        if start.startswith(begins):
            raise DataError(what, path=path, remedy=remedy)
    if own and kind != ".mat":
        raise DataError(
            f"is no {kind} file", path=path, remedy="save it anew, or name it for what it is"
        )


# By ending: who reads such a file, and the libraries that he loads.
ARRAYS: Mapping[str, tuple[Callable[[BinaryIO, Path], Content], tuple[str, ...]]] = (
    MappingProxyType(
        {
            ".mat": (read_mat, ("scipy.io",)),
            ".npz": (read_npz, ()),
            ".parquet": (read_parquet, ("pandas", "pyarrow.parquet")),
        }
    )
)


def read_arrays(file: BinaryIO, path: Path) -> Content:
    """Read a file whose ending `ARRAYS` names.

    Raises
    ------
    DataError
        If it cannot be read.
    """
    reader, libraries = ARRAYS[path.suffix.lower()]
    return read_confined(reader, libraries, file, path)


def read_sheet(file: BinaryIO, path: Path) -> tuple[bytes, tuple[str, ...]]:
    """Return the first sheet of an Excel file as text with tabs, line by line; and all names.

    Raises
    ------
    DataError
        If it cannot be read.
    """
    return read_confined(unpack_sheet, ("pandas", "openpyxl"), file, path)
