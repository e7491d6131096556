"""Several axes of a robot in one file: common keys, and keys of each axis.

Every axis is an interaction design, addressed as ``FILE#AXIS``.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field

from nrs_design.errors import SpecError
from nrs_design.proof.text import quoted
from nrs_design.spec.check import Row
from nrs_design.spec.document import Mapping, Node, Scalar
from nrs_design.spec.edits import node_at
from nrs_design.spec.faults import Location, did_you_mean
from nrs_design.spec.fields import Name, Title
from nrs_design.spec.model import SpecModel, optional, required
from nrs_design.spec.places import place_of

KIND = "task-space"
SEPARATOR = "#"
MAX_AXES = 12
# The name of an axis follows from the file.
_NAMING = ("kind", "name", "title")

_Keys = dict[str, Any]


def _of_each_axis(s: TaskSpaceSpec) -> Iterator[tuple[Location, tuple[TaskSpaceSpec, _Keys]]]:
    return ((("axes", name), (s, keys)) for name, keys in s.axes.items())


def _of_each_part(s: TaskSpaceSpec) -> Iterator[tuple[Location, _Keys]]:
    yield ("common",), s.common
    yield from ((("axes", name), keys) for name, keys in s.axes.items())


class TaskSpaceSpec(SpecModel):
    """Axes that are interaction designs: each has the keys in common and its own."""

    kind: Literal["task-space"] = required("what this file describes")
    name: Name = required("name of the spec; an axis is called NAME-AXIS")
    title: Title | None = optional("what reports are headed with")
    common: _Keys = optional("keys of an interaction-design that every axis has", {})
    axes: Annotated[dict[Name, _Keys], Field(min_length=1, max_length=MAX_AXES)] = required(
        "keys of an interaction-design that each axis has alone, by its name"
    )

    checks = (
        Row(
            "{0}",
            lambda keys: (key for key in _NAMING if key in keys),
            "{0} is said once for the file",
            "remove {0}: the kind is interaction-design, and the name is that of the file and the "
            "axis",
            parts=_of_each_part,
        ),
        Row(
            "{0}",
            lambda item: (key for key in item[1] if key in item[0].common),
            "{0} is said of this axis, and of all in common",
            "move {0} from common to the axes, or remove it here",
            parts=_of_each_axis,
        ),
    )


def file_of(path: Path) -> Path:
    """Return the file of an address: without ``#AXIS``, unless a file is called so."""
    file, mark, _ = str(path).rpartition(SEPARATOR)
    return Path(file) if mark and file and not os.path.exists(path) else path


def address(file: Path, axis: str) -> Path:
    """Return how an axis of a file is named."""
    return Path(f"{file}{SEPARATOR}{axis}")


def is_task_space(root: Node) -> bool:
    """Tell whether a document holds axes."""
    kind = root.entries.get("kind") if isinstance(root, Mapping) else None
    return isinstance(kind, Scalar) and kind.text == KIND


def axis_document(root: Node, said: TaskSpaceSpec, path: Path) -> Mapping:
    """Return an axis as the document of an interaction design, with its places in the file.

    The path is the address of the axis; a `SpecError` if it names none of them.
    """
    file, known = file_of(path), tuple(said.axes)
    if file == path:
        listed = ", ".join(known)
        raise SpecError(
            f"this file holds several axes: {listed}",
            path=path,
            remedy=f"name one, such as {address(path, known[0])}; check, certify-switching, "
            "optimize, report and gate take them all",
        )
    axis = str(path).removeprefix(f"{file}{SEPARATOR}")
    own = node_at(root, ("axes", axis))
    if not isinstance(root, Mapping) or not isinstance(own, Mapping):
        raise SpecError(
            f"there is no axis {quoted(axis)} in this file",
            path=file,
            remedy=did_you_mean(axis, known),
        )
    place = place_of(root, ("axes", axis), at_key=True)
    heads = {"kind": "interaction-design", "name": f"{said.name}-{axis}"}
    if said.title is not None:
        heads["title"] = f"{said.title}: {axis}"
    entries: dict[str, Node] = {key: Scalar(text, place) for key, text in heads.items()}
    keys = dict.fromkeys(heads, place)
    for part in (root.entries.get("common"), own):
        if isinstance(part, Mapping):
            entries |= part.entries
            keys |= part.keys
    return Mapping(entries, keys, place)
