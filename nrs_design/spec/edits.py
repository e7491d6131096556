"""Edits of a document: values that a person could have written instead."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path

from nrs_design.spec.document import Data, Mapping, Node, Position, Scalar, Sequence, steps_to

Keys = tuple[str | int, ...]
# A place and its new value; None removes it.
Edit = tuple[Keys, Data | None]

_SAID: ContextVar[tuple[str, tuple[Edit, ...]] | None] = ContextVar("said", default=None)

# Keys that may change without a change of identified values.
NOT_IDENTIFIED = frozenset({"provenance", "accept_doubt", "range_id", "load_inertia"})


def node_at(root: Node, at: Keys) -> Node | None:
    """Return the value at a place of a document, or None without one."""
    nodes = [root, *(node for _, node in steps_to(root, at))]
    return nodes[-1] if len(nodes) > len(at) else None


def identified_above(root: Node, at: Keys) -> tuple[Keys, ...]:
    """Return the place of the notes of identification about the values at a place, if any.

    That holds of no others.
    """
    for depth in range(len(at) - 1, 0, -1):
        node = node_at(root, at[:depth])
        if isinstance(node, Mapping) and "range_id" in node.entries:
            said = ("range_id", "range_covers") if at[depth] not in NOT_IDENTIFIED else ()
            return tuple((*at[:depth], key) for key in said if key in node.entries)
    return ()


def with_edits(root: Node, edits: Iterable[Edit]) -> Node:
    """Return a document with all edits, without notes of identification about the old values."""
    edits = tuple(edits)
    for at in dict.fromkeys(key for place, _ in edits for key in identified_above(root, place)):
        root = changed(root, at, None)
    for at, said in edits:
        root = changed(root, at, said)
    return root


def changed(root: Node, at: Keys, said: Data | None) -> Node:
    """Return a document that says something else at one place; everything keeps its position.

    The mapping or list above the place is there; a key that it lacks goes last. None leaves the key
    or the item out.
    """
    node = _changed(root, at, said, root.position)
    assert node is not None, "a document is never left out"
    return node


def _changed(node: Node | None, at: Keys, said: Data | None, place: Position) -> Node | None:
    if not at:
        return None if said is None else _node(said, place if node is None else node.position)
    assert not isinstance(node, Scalar | None)
    first, rest = at[0], at[1:]
    if isinstance(node, Sequence):
        assert isinstance(first, int)
        item = _changed(node.items[first], rest, said, node.position)
        kept = () if item is None else (item,)
        return Sequence((*node.items[:first], *kept, *node.items[first + 1 :]), node.position)
    key = str(first)
    place = node.keys.get(key, node.position)
    value = _changed(node.entries.get(key), rest, said, place)
    entries = {name: old for name, old in node.entries.items() if name != key or value is not None}
    if value is not None:
        entries[key] = value
    return Mapping(entries, {name: node.keys.get(name, place) for name in entries}, node.position)


def _node(said: Data, place: Position) -> Node:
    if isinstance(said, str):
        return Scalar(said, place)
    if isinstance(said, tuple):
        return Sequence(tuple(_node(item, place) for item in said), place)
    entries = {key: _node(value, place) for key, value in said.items()}
    return Mapping(entries, dict.fromkeys(entries, place), place)


def in_one_line(said: Data) -> str:
    """Return a value as one line of a spec."""
    if isinstance(said, str):
        return said
    if isinstance(said, tuple):
        return f"[{', '.join(map(in_one_line, said))}]"
    return f"{{{', '.join(f'{key}: {in_one_line(value)}' for key, value in said.items())}}}"


@contextmanager
def saying_instead(file: Path, edits: Iterable[Edit]) -> Iterator[None]:
    """Read a file as if it held other values; read other files unchanged.

    No file is written, names of others stay relative to its folder, and everything keeps its place.
    """
    token = _SAID.set((os.path.realpath(file), tuple(edits)))
    try:
        yield
    finally:
        _SAID.reset(token)


def as_read(root: Node, file: Path) -> Node:
    """Return the document of a file as it is to be read: changed within `saying_instead`."""
    said = _SAID.get()
    if said is None or said[0] != os.path.realpath(file):
        return root
    return with_edits(root, said[1])
