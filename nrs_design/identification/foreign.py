"""Readers of files that other programs have written: MATLAB, NumPy, Parquet, Excel.

They run in a process of their own (`nrs_design.confined`), which loads this module and no more.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from nrs_design.errors import DataError

Arrays = dict[str, NDArray[Any]]
# Columns by name, and the words that the file holds beside them.
Content = tuple[Arrays, tuple[str, ...]]

MAX_BYTES = 1 << 30
_EXTRA = "pip install 'nrs-design[tables]', or save it as CSV"
# With more, the columns of a matrix are no signals.
_MOST_COLUMNS = 100
# Of NumPy: truth, integers, floats, complex, text, times.
_PLAIN_KINDS = "biufcSUmM"
_LONGEST_WORD = 1000


def read_mat(file: BinaryIO, path: Path) -> Content:
    """Read the variables of a MATLAB file.

    The field f of a structure s is called ``s.f``, the first column of a matrix ``data(:,1)``.

    Parameters
    ----------
    file : binary file
        At its beginning.
    path : Path
        For errors.

    Raises
    ------
    DataError
        If it is damaged.
    """
    from scipy.io import loadmat

    _check_size(file, path)
    # Its types name paths only.
    opened: Any = file
    with _reading(path, "MATLAB"):
        content = loadmat(opened, squeeze_me=True, struct_as_record=False)
    _check_objects(content, path)
    variables = _flat({k: v for k, v in content.items() if not k.startswith("__")})
    return _sorted(variables, "{}(:,{})", 1)


def _check_objects(content: Mapping[str, Any], path: Path) -> None:
    """Refuse objects of classes (a timetable, a table), which MATLAB alone can read."""
    from scipy.io.matlab import MatlabFunction, MatlabOpaque

    if any(isinstance(value, MatlabOpaque | MatlabFunction) for value in content.values()):
        raise DataError(
            "holds an object of a MATLAB class, such as a timetable, which MATLAB alone can read",
            path=path,
            remedy="save plain columns, such as time_s = seconds(T.Time); or writetimetable to CSV",
        )


def read_npz(file: BinaryIO, path: Path) -> Content:
    """Read the arrays of a NumPy archive; never an object, which would run its own code.

    A matrix has its columns under names as in ``data[:,0]``.
    """
    import zipfile

    with _reading(path, "NumPy"):
        unpacked = sum(info.file_size for info in zipfile.ZipFile(file).infolist())
    if unpacked > MAX_BYTES:
        raise DataError("unpacks to over 1 GiB", path=path, remedy="save the columns needed")
    file.seek(0)
    with _reading(path, "NumPy"), np.load(file, allow_pickle=False) as archive:
        return _sorted(archive.items(), "{}[:,{}]", 0)


def read_parquet(file: BinaryIO, path: Path) -> Content:
    """Read the columns of a Parquet file; an index with a name is one, too."""
    _check_size(file, path)
    pandas = _pandas(path, "pyarrow")
    with _reading(path, "Parquet"):
        frame = pandas.read_parquet(file)
        if any(frame.index.names):
            frame = frame.reset_index()
        columns = ((str(name), np.asarray(frame[name])) for name in frame.columns)
        return _sorted(columns, "{}[:,{}]", 0)


def unpack_sheet(file: BinaryIO, path: Path) -> tuple[bytes, tuple[str, ...]]:
    """Return the first sheet of an Excel file as text with tabs, line by line; and all names."""
    _check_size(file, path)
    pandas = _pandas(path, "openpyxl")
    with _reading(path, "Excel"), pandas.ExcelFile(file, engine="openpyxl") as book:
        names = tuple(map(str, book.sheet_names))
        frame = book.parse(0, header=None, dtype=object)
    rows = ("\t".join(map(_cell, row)) for row in frame.itertuples(index=False))
    return "\n".join(rows).encode(), names


@contextmanager
def _reading(path: Path, kind: str) -> Iterator[None]:
    """Keep libraries silent; whatever they raise says that the file is damaged."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            yield
        except MemoryError:
            raise
        except Exception as error:
            raise DataError(
                f"is no readable {kind} file ({_first_line(error)})",
                path=path,
                remedy="save it anew, or as CSV",
            ) from error


def _first_line(error: Exception) -> str:
    text = str(error).strip().splitlines()
    return (text[0] if text else type(error).__name__)[:100]


def _check_size(file: BinaryIO, path: Path) -> None:
    size = file.seek(0, 2)
    file.seek(0)
    if size > MAX_BYTES:
        raise DataError("has more than 1 GiB", path=path, remedy="save the columns needed")


def _pandas(path: Path, engine: str) -> Any:
    """Return pandas, if it and what it reads such a file with are installed."""
    try:
        import_module(engine)
        return import_module("pandas")
    except ImportError as error:
        raise DataError(
            f"reading {path.suffix} files needs {error.name}, which is not installed",
            path=path,
            remedy=_EXTRA,
        ) from None


def _cell(value: object) -> str:
    if value is None or value != value:
        return ""
    return str(value).replace("\t", " ").replace("\n", " ")


def _flat(values: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    for name, value in values.items():
        fields = getattr(value, "_fieldnames", None)
        if fields is None:
            yield prefix + name, value
        else:
            yield from _flat({f: getattr(value, f) for f in fields}, f"{prefix}{name}.")


def _sorted(items: Iterable[tuple[str, Any]], column: str, first: int) -> Content:
    """Return all arrays, those that are no single number first, and the words among them.

    Parameters
    ----------
    items : iterable of tuple
        Names and values.
    column, first : str and int
        What a column of a matrix is called, and the number of the first one.
    """
    found: Arrays = {}
    for name, value in items:
        array = np.asarray(value)
        if array.ndim == 2 and 1 < array.shape[1] <= min(array.shape[0], _MOST_COLUMNS):
            found |= {column.format(name, i): row for i, row in enumerate(array.T, first)}
        else:
            found[name] = array
    arrays = dict(sorted(found.items(), key=lambda item: item[1].size < 2))
    words = [name for name, value in arrays.items() if value.dtype.kind in "US"]
    texts = tuple(" ".join(map(str, arrays[name].reshape(-1)[:100])) for name in words)
    return {name: _plain(value) for name, value in arrays.items()}, texts


def _plain(array: NDArray[Any]) -> NDArray[Any]:
    """Return an array of numbers, times or text; what holds anything else becomes text."""
    if array.dtype.kind in _PLAIN_KINDS:
        return array
    texts = [str(value)[:_LONGEST_WORD] for value in array.reshape(-1).tolist()]
    return np.array(texts, dtype=str).reshape(array.shape)
