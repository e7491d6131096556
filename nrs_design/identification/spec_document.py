"""The text of a spec that is changed in few places, and keeps its comments."""

from __future__ import annotations

import io
import re
from collections.abc import Sequence
from typing import Any, NamedTuple

from nrs_design.errors import SpecError
from nrs_design.spec.describe import describe
from nrs_design.spec.document import Data, Node, to_data
from nrs_design.spec.load import LoadedSpec, parse_spec
from nrs_design.spec.task_space import file_of

_COMMENT = re.compile(r"(?m)(?<!\S)#.*$")
# A longer text is a sentence, and no quantity.
_SENTENCE = 40


class Merged(NamedTuple):
    """A spec with a result in it."""

    text: str  # Text of the spec
    doubts: tuple[str, ...]  # Reasons to doubt a proof with the result
    accepted: bool  # Whether the spec has accept_doubt

    @property
    def fails_gate(self) -> bool:
        """Whether the gate fails on the doubts."""
        return bool(self.doubts) and not self.accepted


class SpecDocument:
    """A YAML text that is changed in few places."""

    def __init__(self, loaded: LoadedSpec) -> None:
        from ruamel.yaml import YAML
        from ruamel.yaml.util import load_yaml_guess_indent

        self._loaded = loaded
        # An axis of several is written as a spec of its own, without the comments of their file.
        self._given = loaded.text if file_of(loaded.path) == loaded.path else _dump(loaded.root)
        _, indent, offset = load_yaml_guess_indent(self._given)
        self._yaml = YAML(typ="rt")
        self._yaml.preserve_quotes = True
        # Lines are never folded anew.
        self._yaml.width = 1 << 20
        self._yaml.indent(mapping=2, sequence=indent or 4, offset=2 if offset is None else offset)
        self.root: Any = self._yaml.load(self._given)

    def set_key(self, node: Any, key: str, value: object) -> None:
        """Set a key; a new one goes second to last, as the last one carries what comes after."""
        flow = _flow(value)
        if key in node or not len(node):
            node[key] = flow
        else:
            node.insert(max(len(node) - 1, 1), key, flow)

    def drop(self, node: Any, key: str) -> None:
        """Remove a key, but not the comments that follow it."""
        if key not in node:
            return
        comments = node.ca.items.pop(key, None)
        del node[key]
        if comments is not None and len(node):
            node.ca.items.setdefault(list(node)[-1], comments)

    def text(self) -> str:
        """Return the new text; a `SpecError` if it is no valid spec, or a comment would be lost."""
        stream = io.StringIO()
        self._yaml.dump(self.root, stream)
        text = stream.getvalue()
        if "\r\n" in self._given:
            # Comments have kept theirs.
            text = text.replace("\r\n", "\n").replace("\n", "\r\n")
        removals = [line for line in _comments(self._given) if line not in set(_comments(text))]
        if removals:
            raise SpecError(
                f"the comment {removals[0]!r} would be lost",
                path=self._loaded.path,
                remedy="move it out of the value that is replaced",
            )
        parse_spec(text, self._loaded.path)
        return text


def spec_changes(loaded: LoadedSpec, text: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return changed and removed fields of a new spec text, one line for each field."""
    old, new = (
        {row.name: row.written for row in describe(spec)}
        for spec in (loaded.spec, parse_spec(text))
    )
    was = {name: old.get(name, "not there") for name in new}
    changed = (f"{n}: {was[n]} -> {w}" for n, w in new.items() if w != was[n])
    removals = (f"{n}: {w}" for n, w in old.items() if n not in new)
    return tuple(changed), tuple(removals)


def _dump(root: Node) -> str:
    """Write a document as it was read."""
    from ruamel.yaml import YAML

    stream, writer = io.StringIO(), YAML()
    writer.width = 1 << 20
    writer.dump(convert_data(to_data(root)), stream)
    return stream.getvalue()


def convert_data(data: Data) -> Any:
    """Convert a document to lists and dictionaries, and texts of digits to integers."""
    if isinstance(data, str):
        return int(data) if data.isdecimal() else data
    if isinstance(data, tuple):
        return [convert_data(item) for item in data]
    return {key: convert_data(item) for key, item in data.items()}


def _flow(value: object) -> object:
    """Return a value in flow style, except for a list of mappings or of sentences."""
    from ruamel.yaml.comments import CommentedMap, CommentedSeq

    if isinstance(value, dict):
        mapping = CommentedMap({key: _flow(item) for key, item in value.items()})
        mapping.fa.set_flow_style()
        return mapping
    if isinstance(value, list):
        sequence = CommentedSeq(_flow(item) for item in value)
        if not any(isinstance(item, dict) or len(str(item)) > _SENTENCE for item in value):
            sequence.fa.set_flow_style()
        return sequence
    return value


def _comments(text: str) -> Sequence[str]:
    """Return all comments of a YAML text; a quoted ``#`` after a blank counts as a comment."""
    return [found.group().strip() for found in _COMMENT.finditer(text)]
