"""The parameters of a node as ROS 2 reads them from YAML: dotted names, typed values, places."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

from nrs_design.errors import Fault, SpecError
from nrs_design.proof.text import quoted
from nrs_design.spec.document import Mapping as Tree
from nrs_design.spec.document import Node, Position, Scalar, Sequence, parse_document, read_source
from nrs_design.spec.exact import parse_exact

KEY = "ros__parameters"
# Types of a text in rcl_yaml_param_parser: truth value, integer, else floating-point number.
_TRUE = frozenset({"Y", "y", "yes", "Yes", "YES", "true", "True", "TRUE", "on", "On", "ON"})
_FALSE = frozenset({"N", "n", "no", "No", "NO", "false", "False", "FALSE", "off", "Off", "OFF"})
_INTEGER = re.compile(r"[+-]?[0-9]+")


@dataclass(frozen=True, slots=True)
class RosNode:
    """A node of ROS 2 and its parameters."""

    name: str  # With its namespace, as the file says
    position: Position  # Begin of its parameters
    values: Mapping[str, Node]  # By dotted name
    places: Mapping[str, Position]  # Place of each name and each level

    @property
    def namespace(self) -> str:
        """Its name but for the last part."""
        return self.name.rpartition("/")[0]

    @property
    def base_name(self) -> str:
        """The last part of its name."""
        return self.name.rpartition("/")[2]

    def may_share(self, second: RosNode) -> bool:
        """Tell whether two nodes may share parameters, by a wildcard or the same name.

        Which of two counts depends on the release of ROS 2 and on their order.
        """
        if "*" in self.name and "*" in second.name:
            # Some node may be meant by both.
            bases = self.base_name, second.base_name
            return bases[0] == bases[1] or "*" in "".join(bases)
        return _means(self.name, second.name) or _means(second.name, self.name)

    def matches_node(self, second: RosNode) -> bool:
        """Tell whether the name is a wildcard that matches a node without wildcard."""
        return "*" in self.name and "*" not in second.name and _means(self.name, second.name)

    def fault(self, name: str, message: str, remedy: str, index: int | None = None) -> Fault:
        """Return a fault at a parameter, or at one item of its list."""
        place = self.place(name, index)
        return Fault(f"{self.name}: {name}: {message}", place.line, place.column, remedy)

    def place(self, name: str, index: int | None = None) -> Position:
        """Return the place of a parameter, or of its item; by default the place of the node."""
        value = self.values.get(name)
        if index is not None and isinstance(value, Sequence) and index < len(value.items):
            return value.items[index].position
        return self.places.get(name, self.position)


def _means(pattern: str, name: str) -> bool:
    """Tell whether a pattern matches a name; ``**`` matches any parts, ``*`` a single part."""
    parts = pattern.strip("/").split("/")
    patterns = (
        "(/[^/]+)*" if part == "**" else "/[^/]+" if "*" in part else f"/{re.escape(part)}"
        for part in parts
    )
    return re.fullmatch("".join(patterns), f"/{name.strip('/')}") is not None


def read_nodes(path: Path) -> tuple[RosNode, ...]:
    """Read a parameter file: YAML with nodes that hold ``ros__parameters``."""
    return parse_nodes(read_source(path), path)


def parse_nodes(text: str, path: Path) -> tuple[RosNode, ...]:
    """Read the text of a parameter file; the path is what messages call it."""
    root = parse_document(text, path)
    found = tuple(_nodes(root, ()))
    if not found:
        raise SpecError(
            f"no node of ROS 2 is in this file: nothing has the key {KEY}",
            path=path,
            remedy=f"name a parameter file: `NODE: {{{KEY}: {{...}}}}`",
        )
    return found


def _nodes(tree: Node, namespace: tuple[str, ...]) -> Iterator[RosNode]:
    if not isinstance(tree, Tree):
        return
    for key, value in tree.entries.items():
        if key == KEY and isinstance(value, Tree):
            flat = list(_flat(value, ""))
            values = {name: node for name, node, _ in flat if not isinstance(node, Tree)}
            places = {name: place for name, _, place in flat}
            yield RosNode("/".join(namespace) or "/", tree.keys[key], values, places)
        else:
            yield from _nodes(value, (*namespace, key.strip("/") or key))


def _flat(tree: Tree, prefix: str) -> Iterator[tuple[str, Node, Position]]:
    """Yield name, value and place of parameters and levels; a dot in a key is a level."""
    for key, value in tree.entries.items():
        name = f"{prefix}{key}"
        yield name, value, tree.keys[key]
        if isinstance(value, Tree):
            yield from _flat(value, f"{name}.")


def read_double(text: str) -> Fraction:
    """Read a double exactly as written; like the node of ROS 2, refuse an integer."""
    value = parse_exact(text)
    if _INTEGER.fullmatch(text):
        raise SpecError(
            f"{quoted(text)} is an integer for ROS 2, and a floating-point number is wanted: the "
            "controller refuses to start",
            remedy=f"write {text}.0",
        )
    if "/" in text:
        raise SpecError(f"{quoted(text)} is no number for ROS 2", remedy="write a decimal")
    return value


def read_integer(text: str) -> Fraction:
    """Read an integer by the rules of ROS 2."""
    if not _INTEGER.fullmatch(text):
        raise SpecError(f"{quoted(text)} is no integer", remedy="write digits without a point")
    return parse_exact(text)


def read_bool(text: str) -> Fraction:
    """Read a truth value by the rules of ROS 2, as 1 or 0."""
    if text in _TRUE or text in _FALSE:
        return Fraction(text in _TRUE)
    raise SpecError(f"{quoted(text)} is no truth value", remedy="write true or false")


def texts(value: Node) -> list[Scalar] | None:
    """Return the texts of a single value or of a list, or None where it holds something else."""
    items = value.items if isinstance(value, Sequence) else (value,)
    scalars = [item for item in items if isinstance(item, Scalar)]
    return scalars if len(scalars) == len(items) else None
