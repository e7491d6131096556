"""Every small change that can be made to the fields of a certificate."""

import copy
from collections.abc import Iterator
from fractions import Fraction
from typing import Any

Path = tuple[str | int, ...]

WRONG_TYPES: tuple[Any, ...] = (None, True, 1.5, "1e3", "nan", "-1", [], {}, [[]], "0x1")


def mutations(fields: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    for path, value in _nodes(fields):
        for words, changed in _changes(value):
            yield f"{'.'.join(map(str, path))}: {words}", _with(fields, path, changed)
    for key in fields:
        yield f"{key}: gone", {k: v for k, v in fields.items() if k != key}


def _nodes(value: Any, path: Path = ()) -> Iterator[tuple[Path, Any]]:
    if path:
        yield path, value
    if isinstance(value, dict):
        for key, item in value.items():
            yield from _nodes(item, (*path, key))
    if isinstance(value, list):
        for index, item in enumerate(value):
            yield from _nodes(item, (*path, index))


def _changes(value: Any) -> Iterator[tuple[str, Any]]:
    if type(value) is int:
        yield "sign", -value
        yield "one more", value + 1
        yield "one less", value - 1
        yield "a bit", value ^ (1 << max(value.bit_length() - 2, 0))
        yield "huge", 10**400
        yield "zero", 0
    if isinstance(value, str):
        yield from _changed_text(value)
    if isinstance(value, list):
        yield from _changed_list(value)
    for wrong in WRONG_TYPES:
        if type(wrong) is not type(value) or wrong != value:
            yield f"{wrong!r} instead", wrong


def _changed_text(text: str) -> Iterator[tuple[str, str]]:
    yield "another name", f"{text}x"
    yield "the other mode", {"m0": "m1", "m1": "m0"}.get(text, "m0")
    try:
        ratio = Fraction(text)
    except ValueError:
        return
    for words, changed in (
        ("twice", 2 * ratio),
        ("half", ratio / 2),
        ("a millionth more", ratio * Fraction(1_000_001, 1_000_000)),
        ("its negative", -ratio),
        ("zero", Fraction(0)),
        ("huge", Fraction(10**400)),
    ):
        yield words, str(changed)
    yield "not reduced", f"{2 * ratio.numerator}/{2 * ratio.denominator}"
    yield "over zero", f"{ratio.numerator}/0"


def _changed_list(items: list[Any]) -> Iterator[tuple[str, list[Any]]]:
    yield "reversed", items[::-1]
    for index, item in enumerate(items):
        yield f"without {index}", items[:index] + items[index + 1 :]
        yield f"{index} twice", [*items[: index + 1], copy.deepcopy(item), *items[index + 1 :]]


def _with(fields: dict[str, Any], path: Path, value: Any) -> dict[str, Any]:
    changed = copy.deepcopy(fields)
    node: Any = changed
    for key in path[:-1]:
        node = node[key]
    node[path[-1]] = value
    return changed
