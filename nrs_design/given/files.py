"""Modes and a matrix P from files of other programs: NumPy, MATLAB, JSON."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

from nrs_design.errors import DataError
from nrs_design.proof.text import quoted

MAX_BYTES = 256 * 2**20
_OPTIONAL = ("rate", "time")
_CONTENT = "it holds `P`, and the modes as `A` (or A1, A2, ...), and may hold `rate` and `time`"


@dataclass(frozen=True, slots=True)
class Proposal:
    """A quadratic function that somebody proposes for a family of modes.

    Parameters
    ----------
    modes : mapping
        Name to matrix.
    P : object
        The matrix of ``x' P x``.
    rate : object
        At which rate it is said to decrease; None if nothing is said.
    time : str or None
        ``continuous``, ``discrete``, or None if nothing is said.
    """

    modes: Mapping[str, object]
    P: object
    rate: object
    time: str | None


def read_proposal(path: Path) -> Proposal:
    """Read modes and P from a ``.npz``, ``.mat`` or ``.json`` file.

    Parameters
    ----------
    path : Path
        The variables are `P`, the modes as `A`, and optionally `rate` and `time` ("continuous" or
        "discrete"). `A` is one matrix; a stack of them (NumPy: shape (m, n, n), MATLAB:
        n x n x m); in JSON a list of matrices or an object that names them; in MATLAB a cell array
        too. Or every matrix is a variable of its own: `A1`, `A2`, ... JSON numbers are read as the
        decimals that are written; those of the other formats are binary numbers.

    Raises
    ------
    DataError
        If the file cannot be read, or does not hold these.
    """
    readers: dict[str, Callable[[Path], dict[str, Any]]] = {
        ".npz": _read_npz,
        ".mat": _read_mat,
        ".json": _read_json,
    }
    reader = readers.get(path.suffix.lower())
    if reader is None:
        raise DataError(
            f"files named {path.suffix or 'without an ending'!r} are not read",
            path=path,
            remedy="name a file .npz, .mat or .json",
        )
    if not path.is_file():
        raise DataError("is no file", path=path, remedy="check the path")
    if path.stat().st_size > MAX_BYTES:
        raise DataError(f"is larger than {MAX_BYTES} bytes", path=path, remedy="name a smaller one")
    try:
        content = reader(path)
    except Exception as error:
        # Readers of foreign formats raise what they like on files that are not theirs.
        raise DataError(
            f"cannot be read ({error or type(error).__name__})", path=path, remedy=_CONTENT
        ) from error
    return _proposal(content, path)


def _proposal(content: dict[str, Any], path: Path) -> Proposal:
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


def _modes(content: dict[str, Any], path: Path) -> dict[str, object]:
    numbered = sorted(filter(_is_numbered, content), key=lambda key: int(key[1:]))
    if "A" in content and numbered:
        raise DataError("holds both `A` and numbered modes", path=path, remedy="keep one of them")
    if numbered:
        return {key: content[key] for key in numbered}
    held = content.get("A")
    if isinstance(held, dict) and held:
        return held
    if isinstance(held, list) and held:
        single = not isinstance(held[0], list) or not isinstance(held[0][0], list)
        matrices = [held] if single else held
        return {f"A{index + 1}": matrix for index, matrix in enumerate(matrices)}
    raise DataError("holds no modes", path=path, remedy=_CONTENT)


def _is_numbered(key: str) -> bool:
    return key[:1] == "A" and key[1:].isdecimal()


def _is_matrix_name(key: str) -> bool:
    return key in ("A", "P") or _is_numbered(key)


def _read_json(path: Path) -> dict[str, Any]:
    content = json.loads(
        path.read_text(encoding="utf-8"),
        parse_float=str,
        parse_constant=_not_finite,
        object_pairs_hook=_unique,
    )
    if not isinstance(content, dict):
        raise ValueError("expected a JSON object")
    # A workspace of NumPy or MATLAB may hold anything; such a file is written for this purpose.
    if foreign := [key for key in content if key not in _OPTIONAL and not _is_matrix_name(key)]:
        raise ValueError(f"{quoted(foreign[0])} is not known here")
    return content


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """Refuse a mode that another of its name would hide."""
    found = dict(pairs)
    if len(found) < len(pairs):
        raise ValueError("a name occurs twice in one object")
    return found


def _read_npz(path: Path) -> dict[str, Any]:
    import numpy as np

    with np.load(path, allow_pickle=False) as archive:
        return {key: archive[key].tolist() for key in archive.files}


def _read_mat(path: Path) -> dict[str, Any]:
    from scipy.io import loadmat

    variables = loadmat(path)
    return {key: _plain(value) for key, value in variables.items() if not key.startswith("__")}


def _plain(value: Any) -> Any:
    """Return a MATLAB array as nested lists: scalars and texts alone, stacks matrix by matrix."""
    if value.dtype == object:
        return [_plain(cell) for cell in value.ravel()]
    if value.dtype.kind == "U":
        return str(value.ravel()[0]) if value.size else ""
    if value.ndim == 3:
        return [value[:, :, k].tolist() for k in range(value.shape[2])]
    return value.tolist()


def _not_finite(text: str) -> NoReturn:
    raise ValueError(f"{text} is not a finite number")
