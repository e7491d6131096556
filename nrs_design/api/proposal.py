"""Modes and a matrix P from a JSON file, whichever program found them."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

from nrs_design.errors import DataError
from nrs_design.files import open_regular, read_json_text, unique_keys
from nrs_design.proof.text import quoted

MAX_BYTES = 16 * 2**20
# Entries of all matrices.
MAX_ENTRIES = 200_000
_NUMBERED = re.compile("A[0-9]{1,6}")
_KNOWN = ("P", "A", "rate", "time")
_CONTENT = "it holds `P`, and the modes as `A` (or A1, A2, ...), and may hold `rate` and `time`"


@dataclass(frozen=True, slots=True)
class Proposal:
    """A quadratic function that somebody proposes for a family of modes."""

    modes: Mapping[str, object]  # Name to matrix
    P: object  # The matrix of ``x' P x``
    rate: object  # Stated rate of decrease, or None
    time: str | None  # ``continuous``, ``discrete``, or None if nothing is said


def read_proposal(path: Path) -> Proposal:
    """Read `P`, the modes `A`, and perhaps `rate` and `time` from a ``.json`` file.

    `A` is one matrix, a list of matrices or an object that names them; or every matrix has a key of
    its own: `A1`, `A2`, ... Numbers are the decimals that are written.
    """
    if path.suffix.lower() != ".json":
        raise DataError(
            f"files named {path.suffix or 'without an ending'!r} are not read",
            path=path,
            remedy="write P and the modes as JSON, or call nrs_design.check_lyapunov on arrays",
        )
    try:
        with open_regular(path) as file:
            raw = file.read(MAX_BYTES + 1)
        if len(raw) > MAX_BYTES:
            raise ValueError(f"larger than {MAX_BYTES} bytes")
        return _proposal(_read_json(raw))
    except (OSError, ValueError, RecursionError) as error:
        said = error.strerror if isinstance(error, OSError) else error
        raise DataError(f"cannot be read ({said})", path=path, remedy=_CONTENT) from error


def _proposal(content: Mapping[str, Any]) -> Proposal:
    if "P" not in content:
        raise ValueError("it holds no `P`")
    time = content.get("time")
    if time not in (None, "continuous", "discrete"):
        raise ValueError("its `time` is neither continuous nor discrete")
    return Proposal(_modes(content), content["P"], content.get("rate"), time)


def _modes(content: Mapping[str, Any]) -> dict[str, object]:
    numbered = sorted(filter(_NUMBERED.fullmatch, content), key=lambda key: int(key[1:]))
    held = content.get("A")
    if "A" in content and numbered:
        raise ValueError("it holds both `A` and numbered modes")
    if numbered:
        return {key: content[key] for key in numbered}
    if isinstance(held, dict) and held:
        return held
    if isinstance(held, list) and held:
        rows = held[0] if isinstance(held[0], list) else []
        single = not (rows and isinstance(rows[0], list))
        matrices = [held] if single else held
        return {f"A{index + 1}": matrix for index, matrix in enumerate(matrices)}
    raise ValueError("it holds no modes")


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
    if foreign := [key for key in content if key not in _KNOWN and not _NUMBERED.fullmatch(key)]:
        raise ValueError(f"{quoted(foreign[0])} is not known here")
    if _count(content) > MAX_ENTRIES:
        raise ValueError(f"it holds more than {MAX_ENTRIES} entries")
    return content


def _count(value: object) -> int:
    """Count the entries of nested lists and objects."""
    if isinstance(value, dict):
        return sum(map(_count, value.values()))
    return sum(map(_count, value)) if isinstance(value, list) else 1


def _not_finite(text: str) -> NoReturn:
    raise ValueError(f"{text} is not a finite number")
