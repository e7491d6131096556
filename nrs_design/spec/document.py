"""YAML text as a tree of scalars that stay text, each with its line and column.

The limits are checked on the stream of parser events, before any tree grows, so that a hostile
file is refused early. No scalar is ever turned into a float: decimals stay as written.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import NoReturn

from ruamel.yaml import YAML, events
from ruamel.yaml.error import MarkedYAMLError, YAMLError

from nrs_design.errors import Fault, SpecError
from nrs_design.files import is_page, open_regular
from nrs_design.proof.text import quoted
from nrs_design.spec.syntax import explain_syntax, fault_mark

MAX_BYTES = 1024 * 1024
MAX_DEPTH = 20
# Largest number of syntax faults: a hostile file is not read further.
MAX_FAULTS = 100
# Keys and values; the parser takes some ten microseconds for each.
MAX_NODES = 150_000
# Longest text: names, numbers and titles are shorter, and later code relies on that.
MAX_SCALAR = 1000

# Escapes such as "\ud800" make surrogates, which cannot be printed or encoded.
_SURROGATE = re.compile("[\ud800-\udfff]")
_TABLES = {".csv", ".tsv"}
_WORD = re.compile(r"[^\s,\[\]{}]+")
_NULL = re.compile(r"|~|null|Null|NULL")
# Texts that YAML 1.2 reads as a truth value or a number if they are not quoted.
_NOT_TEXT = re.compile(
    r"true|True|TRUE|false|False|FALSE"
    r"|[+-]?[0-9]+|0o[0-7]+|0x[0-9a-fA-F]+"
    r"|[+-]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][+-]?[0-9]+)?"
    r"|[+-]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN)"
)


@dataclass(frozen=True, slots=True)
class Position:
    """A place in a file, line and column counted from 1."""

    line: int
    column: int


@dataclass(frozen=True, slots=True)
class Scalar:
    """A leaf of the tree: the text as written, without the types of YAML."""

    text: str
    position: Position


@dataclass(frozen=True, slots=True)
class Sequence:
    """A list of nodes."""

    items: tuple[Node, ...]
    position: Position


@dataclass(frozen=True, slots=True)
class Mapping:
    """Nodes under distinct text keys, in file order; ``keys`` holds where each key stands."""

    entries: dict[str, Node]
    keys: dict[str, Position]
    position: Position


Node = Scalar | Sequence | Mapping
Data = str | tuple["Data", ...] | dict[str, "Data"]


def read_source(path: Path) -> str:
    """Read the text of a spec file.

    A `SpecError` if it is missing, unreadable, no regular file, empty, a page, larger than 1 MiB or
    not UTF-8.
    """
    content, refused = _read_bytes(path), partial(SpecError, path=path)
    if is_page(content):
        remedy = "name the *.nrs.yaml file it is about"
        raise refused("this is a page, not a spec", remedy=remedy)
    if path.suffix.lower() in _TABLES:
        remedy = "name a *.nrs.yaml file; where a command takes both, the record comes first"
        raise refused("this is a table, not a spec", remedy=remedy)
    if len(content) > MAX_BYTES:
        remedy = "split it into several specs"
        raise refused(f"the file is larger than {MAX_BYTES} bytes", remedy=remedy)
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        if b"\0" in content:
            remedy = "name a *.nrs.yaml file"
            raise refused("the file is not UTF-8 text", remedy=remedy) from None
        before = content[: error.start].decode("utf-8-sig")
        place, remedy = _position(before, len(before)), "save the file in the UTF-8 encoding"
        message = f"byte 0x{content[error.start]:02x} is not UTF-8 text"
        raise refused(message, line=place.line, column=place.column, remedy=remedy) from None
    if not text.strip():
        raise refused("the file is empty", remedy="start from `nrs-design init`")
    return text


def _read_bytes(path: Path) -> bytes:
    refused = partial(SpecError, path=path)
    try:
        if path.exists() and not path.is_file():
            raise refused("this is not a file", remedy="name a *.nrs.yaml file")
        with open_regular(path) as file:
            return file.read(MAX_BYTES + 1)
    except FileNotFoundError:
        raise refused("there is no such file", remedy="check the path") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        remedy = "check path and permissions"
        raise refused(f"the file cannot be read: {reason}", remedy=remedy) from None


def parse_document(text: str, path: Path | None = None) -> Node:
    """Parse one YAML document of plain mappings, lists and scalars, which are text, never numbers.

    A `SpecError`, with line and column, for syntax errors, nesting deeper than 20, more than
    150,000 keys and values, one longer than 1000 characters, anchors, aliases, tags, merge keys,
    duplicate keys, keys that are not text, missing values and several documents.
    """
    root, faults = parse_with_faults(text, path)
    if faults:
        raise SpecError.combine(faults, path)
    return root


def parse_with_faults(text: str, path: Path | None = None) -> tuple[Node, tuple[Fault, ...]]:
    """Parse a document as `parse_document` does; go on after faults that leave the rest readable.

    Returns the tree, in which an empty text stands where a value could not be read, and the faults.
    If the rest cannot be read, the `SpecError` holds the faults before, too.
    """
    builder = _Builder(text, path)
    return builder.build(), tuple(builder.faults)


def steps_to(root: Node, at: Iterable[str | int]) -> Iterator[tuple[Position, Node]]:
    """Yield position and value of each key or item on the path to a place that the file holds."""
    node = root
    for part in at:
        if isinstance(node, Mapping) and part in node.entries:
            place, node = node.keys[str(part)], node.entries[str(part)]
        elif isinstance(node, Sequence) and isinstance(part, int) and part < len(node.items):
            node = node.items[part]
            place = node.position
        else:
            return
        yield place, node


def to_data(node: Node) -> Data:
    """Strip the positions: dicts, tuples and text."""
    if isinstance(node, Scalar):
        return node.text
    if isinstance(node, Sequence):
        return tuple(to_data(item) for item in node.items)
    return {key: to_data(value) for key, value in node.entries.items()}


def hash_meaning(said: object) -> str:
    """Return the SHA-256 of what a document says, as `to_data` or JSON has it, in hexadecimal.

    Two documents share it exactly if they have the same keys in the same order and the same texts:
    comments, line ends, quotes and layout do not count. A spec is read from these texts and from
    nothing else. Order counts because modes are numbered in the order of the controllers.
    """
    canonical = json.dumps(said, separators=(",", ":"), ensure_ascii=True)
    return hashlib.sha256(canonical.encode()).hexdigest()


def _position(text: str, index: int) -> Position:
    """Return line and column of a character."""
    *before, line = re.split(r"\r\n|\n|\r", text[:index])
    return Position(len(before) + 1, len(line) + 1)


def _start(event: events.Event) -> Position:
    mark = event.start_mark
    return Position(mark.line + 1, mark.column + 1)


def _is_missing(event: events.Event) -> bool:
    """Tell whether an event is a scalar without a value."""
    if not isinstance(event, events.ScalarEvent) or event.style is not None:
        return False
    return bool(_NULL.fullmatch(event.value))


class _Builder:
    """Builds the tree from the event stream; recursion is bounded by the depth limit."""

    def __init__(self, text: str, path: Path | None) -> None:
        self._text = text
        self._path = path
        self._events = self._checked_events()
        self.faults: list[Fault] = []

    def build(self) -> Node:
        root: Node | None = None
        for event in self._events:
            if isinstance(event, events.NodeEvent):
                root = self._node(event)
        if root is None:
            self._fail("the file holds no document", Position(1, 1), "start from `nrs-design init`")
        return root

    def _note(self, message: str, place: Position, remedy: str) -> None:
        """Note a fault behind which the file can be read on."""
        self.faults.append(Fault(message, place.line, place.column, remedy))
        if len(self.faults) >= MAX_FAULTS:
            raise SpecError.combine(self.faults, self._path)

    def _fail(self, message: str, place: Position, remedy: str) -> NoReturn:
        """Give up, for instance at a wrong indentation, which leaves the rest unreadable."""
        self._note(message, place, remedy)
        raise SpecError.combine(self.faults, self._path)

    def _raw_events(self) -> Iterator[events.Event]:
        """Parser events; every way in which the parser gives up becomes a SpecError."""
        index = 0
        try:
            for event in YAML(typ="safe", pure=True).parse(self._text):
                index = event.start_mark.index
                yield event
        except YAMLError as error:
            if isinstance(error, MarkedYAMLError):
                mark = fault_mark(error)
                index = mark.index if mark else index
            else:
                index = getattr(error, "position", index)
            message, remedy, index = explain_syntax(error, self._text, index)
            self._fail(message, _position(self._text, index), remedy)
        except (ValueError, ArithmeticError, LookupError):
            # Escapes beyond unicode and absurd version directives end so in the parser.
            place, remedy = _position(self._text, index), "check escapes and directives"
            self._fail("this is not valid YAML", place, remedy)

    def _checked_events(self) -> Iterator[events.Event]:
        self._check_size()
        depth = documents = nodes = 0
        for event in self._raw_events():
            place = _start(event)
            nodes += isinstance(event, events.NodeEvent)
            if nodes > MAX_NODES:
                self._fail_large(place)
            if isinstance(event, events.DocumentStartEvent):
                documents += 1
                if documents > 1:
                    self._fail("the file holds several documents", place, "keep one, without ---")
            elif isinstance(event, events.NodeEvent):
                self._check_node(event, place)
            depth += isinstance(event, events.SequenceStartEvent | events.MappingStartEvent)
            depth -= isinstance(event, events.CollectionEndEvent)
            if depth > MAX_DEPTH:
                self._fail(f"nested deeper than {MAX_DEPTH} levels", place, "flatten the spec")
            yield event

    def _check_size(self) -> None:
        """Refuse a text that would keep the parser busy for long.

        Its time grows with the square of the length of a tag; every comma and every line may be
        followed by one more node.
        """
        for word in _WORD.finditer(self._text):
            if len(word[0]) > MAX_SCALAR:
                self._fail_long(len(word[0]), _position(self._text, word.start()))
        if self._text.count(",") + self._text.count("\n") > MAX_NODES:
            self._fail_large(Position(1, 1))

    def _fail_large(self, place: Position) -> NoReturn:
        remedy = "split it into several specs"
        self._fail(f"the file holds more than {MAX_NODES} keys, values or lines", place, remedy)

    def _fail_long(self, length: int, place: Position) -> NoReturn:
        message = f"a text of {length} characters stands here, at most {MAX_SCALAR} are read"
        self._fail(message, place, "shorten it")

    def _check_node(self, event: events.NodeEvent, place: Position) -> None:
        if isinstance(event, events.ScalarEvent) and len(event.value) > MAX_SCALAR:
            self._fail_long(len(event.value), place)
        if isinstance(event, events.AliasEvent):
            self._note("aliases (*name) are not read", place, "write the value out")
        if event.anchor is not None:
            self._note("anchors (&name) are not read", place, "remove the anchor")
        if getattr(event, "tag", None) is not None:
            self._note("tags (!name) are not read", place, "remove the tag")
        if isinstance(event, events.ScalarEvent) and _SURROGATE.search(event.value):
            self._note("a lone surrogate is not text", place, "remove the escape")

    def _node(self, event: events.NodeEvent) -> Node:
        place = _start(event)
        if isinstance(event, events.AliasEvent):
            return Scalar("", place)
        if _is_missing(event):
            self._note("a value is missing here", place, "write a value or remove the key")
        if isinstance(event, events.ScalarEvent):
            return Scalar(event.value, place)
        if isinstance(event, events.SequenceStartEvent):
            return Sequence(tuple(self._node(item) for item in self._children()), place)
        return self._mapping(place)

    def _children(self) -> Iterator[events.NodeEvent]:
        """Start events of the nodes within the open collection."""
        for event in self._events:
            if isinstance(event, events.CollectionEndEvent):
                return
            if isinstance(event, events.NodeEvent):
                yield event

    def _mapping(self, place: Position) -> Mapping:
        entries: dict[str, Node] = {}
        keys: dict[str, Position] = {}
        children = self._children()
        for event in children:
            key_place = _start(event)
            key = self._key(event, key_place)
            if key in keys:
                self._note(
                    f"the key {quoted(key)} is there twice, first in line {keys[key].line}",
                    key_place,
                    "keep one of them",
                )
            value = self._value(key, key_place, next(children))
            if key not in keys:
                keys[key], entries[key] = key_place, value
        return Mapping(entries, keys, place)

    def _key(self, event: events.NodeEvent, place: Position) -> str:
        if not isinstance(event, events.ScalarEvent):
            self._fail("a key must be text", place, "write `key: value`")
        key: str = event.value
        if event.style is not None:
            return key
        if key == "<<":
            self._note("merge keys (<<) are not read", place, "write the keys out")
        elif _NULL.fullmatch(key) or _NOT_TEXT.fullmatch(key):
            self._note(f"the key {quoted(key)} is not text", place, "put it in quotes or rename it")
        return key

    def _value(self, key: str, key_place: Position, event: events.NodeEvent) -> Node:
        """Read the value of a key; a missing one is reported where the key stands."""
        if _is_missing(event):
            remedy = "write a value or remove the key"
            if key[:1].isdigit():
                # Other faults are dropped then: the number before the comma seems to lack its
                # unit.
                remedy = "write decimals with a point: a comma ends a value"
                self._fail(f"the key {quoted(key)} has no value", key_place, remedy)
            self._note(f"the key {quoted(key)} has no value", key_place, remedy)
            return Scalar("", key_place)
        return self._node(event)
