"""Modes and a matrix P from files of other programs: NumPy, MATLAB, JSON."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any, BinaryIO, NoReturn

from typing_extensions import TypeAliasType

from nrs_design.arrays.exact import refuse_times
from nrs_design.confined import read_confined
from nrs_design.errors import DataError
from nrs_design.files import open_regular, read_json_text, unique_keys
from nrs_design.proof.text import quoted

MAX_BYTES = 16 * 2**20
# Of all matrices together.
MAX_ENTRIES = 200_000
_NUMBERED = re.compile("A[0-9]{1,6}")
_OPTIONAL = ("rate", "time")
_CONTENT = "it holds `P`, and the modes as `A` (or A1, A2, ...), and may hold `rate` and `time`"

# What a file holds, by name: nested lists of numbers and texts.
Plain = TypeAliasType(
    "Plain", "bool | int | float | complex | str | bytes | list[Plain] | dict[str, Plain] | None"
)
Content = dict[str, Plain]


@dataclass(frozen=True, slots=True)
class Proposal:
    """A quadratic function that somebody proposes for a family of modes."""

    modes: Mapping[str, object]  # Name to matrix
    P: object  # The matrix of ``x' P x``
    rate: object  # At which rate it is said to decrease; None if nothing is said
    time: str | None  # ``continuous``, ``discrete``, or None if nothing is said


def read_proposal(path: Path) -> Proposal:
    """Read `P`, the modes `A`, and perhaps `rate` and `time` from ``.npz``, ``.mat`` or ``.json``.

    `A` is one matrix or a stack (NumPy: shape (m, n, n), MATLAB: n x n x m); in JSON a list or an
    object that names them; in MATLAB a cell array too. Or every matrix is a variable of its own:
    `A1`, `A2`, ... JSON numbers are the decimals that are written, all others binary numbers.
    """
    kind = path.suffix.lower()
    if kind not in (*_FOREIGN, ".json"):
        raise DataError(
            f"files named {path.suffix or 'without an ending'!r} are not read",
            path=path,
            remedy="name a file .npz, .mat or .json",
        )
    if not path.is_file():
        raise DataError("is not a file", path=path, remedy="check the path")
    try:
        with open_regular(path) as file:
            return _proposal(_read(file, kind, path), path)
    except OSError as error:
        raise DataError(
            f"cannot be read ({error.strerror})", path=path, remedy="check the path"
        ) from error


def _read(file: BinaryIO, kind: str, path: Path) -> Mapping[str, Any]:
    if os.fstat(file.fileno()).st_size > MAX_BYTES:
        raise DataError(f"is larger than {MAX_BYTES} bytes", path=path, remedy="name a smaller one")
    if kind in _FOREIGN:
        reader, libraries = _FOREIGN[kind]
        return read_confined(reader, libraries, file, path, _CONTENT)
    try:
        return _read_json(file.read(MAX_BYTES))
    except (ValueError, RecursionError) as error:
        raise DataError(f"cannot be read ({error})", path=path, remedy=_CONTENT) from error


def _proposal(content: Mapping[str, Any], path: Path) -> Proposal:
    if "P" not in content:
        raise DataError("holds no `P`", path=path, remedy=_CONTENT)
    modes = _modes(content, path)
    time = content.get("time")
    if time is not None and time not in ("continuous", "discrete"):
        raise DataError("its `time` is not known", path=path, remedy="continuous or discrete")
    return Proposal(modes, content["P"], _scalar(content.get("rate")), time)


def _scalar(value: object) -> object:
    """Unwrap a number that its format holds as an array of one entry."""
    while isinstance(value, list) and len(value) == 1:
        value = value[0]
    return value


def _modes(content: Mapping[str, Any], path: Path) -> dict[str, object]:
    numbered = sorted(filter(_NUMBERED.fullmatch, content), key=lambda key: int(key[1:]))
    if "A" in content and numbered:
        raise DataError("holds both `A` and numbered modes", path=path, remedy="keep one of them")
    if numbered:
        return {key: content[key] for key in numbered}
    held = content.get("A")
    if isinstance(held, dict) and held:
        return held
    if isinstance(held, list) and held:
        rows = held[0] if isinstance(held[0], list) else []
        single = not (rows and isinstance(rows[0], list))
        matrices = [held] if single else held
        return {f"A{index + 1}": matrix for index, matrix in enumerate(matrices)}
    raise DataError("holds no modes", path=path, remedy=_CONTENT)


def _is_matrix_name(key: str) -> bool:
    return key in ("A", "P") or _NUMBERED.fullmatch(key) is not None


def _read_json(raw: bytes) -> dict[str, Any]:
    content = json.loads(
        read_json_text(raw),
        parse_float=str,
        parse_int=str,
        parse_constant=_not_finite,
        object_pairs_hook=unique_keys,
    )
    if not isinstance(content, dict):
        raise ValueError("expected a JSON object")
    # A workspace of NumPy or MATLAB may hold anything; such a file is written for this purpose.
    if foreign := [key for key in content if key not in _OPTIONAL and not _is_matrix_name(key)]:
        raise ValueError(f"{quoted(foreign[0])} is not known here")
    _check_entries(_count(content))
    return content


def unpack_npz(file: BinaryIO, path: Path) -> Content:
    """Return the arrays of a NumPy archive as lists; in a process of its own."""
    import numpy as np

    with np.load(file, allow_pickle=False) as archive:
        arrays = {key: archive[key] for key in archive.files}
    for key, array in arrays.items():
        refuse_times(array, key)
    _check_entries(sum(array.size for array in arrays.values()))
    return {key: array.tolist() for key, array in arrays.items()}


def unpack_mat(file: BinaryIO, path: Path) -> Content:
    """Return the variables of a MATLAB file as lists; in a process of its own."""
    from scipy.io import loadmat

    # It reads from streams, too, which its annotations do not know.
    stream: Any = file
    variables = loadmat(stream)
    arrays = {key: value for key, value in variables.items() if not key.startswith("__")}
    _check_entries(sum(map(_size, arrays.values())))
    return {key: _plain(value) for key, value in arrays.items()}


def _size(value: Any) -> int:
    """Count the entries of a MATLAB array, those of its cells included."""
    return sum(map(_size, value.ravel())) if value.dtype == object else int(value.size)


def _count(value: object) -> int:
    """Count the entries of nested lists and objects."""
    if isinstance(value, dict):
        return sum(map(_count, value.values()))
    return sum(map(_count, value)) if isinstance(value, list) else 1


def _check_entries(count: int) -> None:
    if count > MAX_ENTRIES:
        raise ValueError(f"it holds more than {MAX_ENTRIES} entries")


def _plain(value: Any) -> Any:
    """Return a MATLAB array as nested lists: scalars and texts alone, stacks matrix by matrix."""
    if value.dtype == object:
        return [_plain(cell) for cell in value.ravel()]
    if value.dtype.kind == "U":
        return str(value.ravel()[0]) if value.size else ""
    if value.ndim == 3:
        return [value[:, :, k].tolist() for k in range(value.shape[2])]
    return value.tolist()


# By ending: who reads such a file, and the libraries that he loads.
_FOREIGN: Mapping[str, tuple[Callable[[BinaryIO, Path], Content], tuple[str, ...]]] = (
    MappingProxyType({".npz": (unpack_npz, ("numpy",)), ".mat": (unpack_mat, ("scipy.io",))})
)


def _not_finite(text: str) -> NoReturn:
    raise ValueError(f"{text} is not a finite number")
