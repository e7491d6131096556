"""From a file to a validated spec."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from pydantic import ValidationError

from nrs_design.errors import Fault, SpecError
from nrs_design.models.axis import axis_context
from nrs_design.proof.text import quoted
from nrs_design.spec.document import (
    Mapping,
    Node,
    Position,
    Scalar,
    hash_meaning,
    parse_document,
    parse_with_faults,
    read_source,
    steps_to,
    to_data,
)
from nrs_design.spec.edits import as_read
from nrs_design.spec.faults import did_you_mean
from nrs_design.spec.places import file_faults
from nrs_design.spec.task_space import (
    KIND,
    TaskSpaceSpec,
    address,
    axis_document,
    file_of,
    is_task_space,
)

if TYPE_CHECKING:
    from nrs_design.spec.interaction import InteractionDesignSpec
    from nrs_design.spec.robot import RobotSpec
    from nrs_design.spec.switched_system import SwitchedSystemSpec

    Spec: TypeAlias = InteractionDesignSpec | SwitchedSystemSpec | RobotSpec

# Module of the model of each kind.
_MODELS = {
    "interaction-design": ("interaction", "InteractionDesignSpec"),
    "switched-system": ("switched_system", "SwitchedSystemSpec"),
    "robot": ("robot", "RobotSpec"),
    KIND: ("task_space", "TaskSpaceSpec"),
}
SPEC_KINDS = tuple(_MODELS)


@dataclass(frozen=True, slots=True, kw_only=True)
class LoadedSpec:
    """A spec together with the file that it came from."""

    path: Path  # The file, as the user named it
    sha256: str  # Hash of what the file says, in hexadecimal; see `hash_meaning`
    text: str  # The file's text
    spec: Spec  # The validated content
    # The text as a tree, for positions; parsed once more where it is not given.
    parsed: Node | None = field(default=None, repr=False, compare=False)

    @property
    def facts(self) -> dict[str, Any]:
        """Which spec a result is about, as its JSON document begins."""
        return {"spec": self.spec.name, "spec_sha256": self.sha256}

    @property
    def root(self) -> Node:
        """The text as a tree, in which everything has its line and column."""
        return self.parsed or parse_document(self.text, self.path)

    def place(self, *at: str | int) -> Position:
        """Line and column of a key or item, or of its parent if the file does not hold it."""
        places = [place for place, _ in steps_to(self.root, at)]
        return places[-1] if places else self.root.position


def read_spec(path: str | os.PathLike[str]) -> LoadedSpec:
    """Read and validate a spec file; of one with several axes, one of them: ``FILE#AXIS``.

    A `SpecError`, with path, line, column, message and remedy, if anything about it is wrong.
    """
    named = Path(path)
    file = file_of(named)
    text = read_source(file)
    root, syntax, axes = _document(text, file)
    if axes is not None:
        return _loaded(named, text, axis_document(root, axes, named), ())
    if file != named:
        raise SpecError("this file holds no axes", path=file, remedy=f"name the file alone: {file}")
    return _loaded(file, text, root, syntax)


def read_axes(path: Path) -> tuple[LoadedSpec, ...]:
    """Read a spec file, and every axis of one that holds several; see :func:`read_spec`."""
    return tuple(map(read_spec, axes_at(path)))


def axes_at(path: Path) -> tuple[Path, ...]:
    """Return the addresses of all axes of a file that holds several; else the path itself."""
    if file_of(path) != path:
        return (path,)
    text = read_source(path)
    if KIND not in text:
        return (path,)
    axes = _document(text, path)[2]
    return (path,) if axes is None else tuple(address(path, axis) for axis in axes.axes)


def _document(text: str, file: Path) -> tuple[Node, tuple[Fault, ...], TaskSpaceSpec | None]:
    """Return a document, its syntax faults, and its axes if it holds several."""
    root, syntax = parse_with_faults(text, file)
    root = as_read(root, file)
    axes = _validated(model_of(KIND), root, syntax, file) if is_task_space(root) else None
    return root, syntax, axes


def respecified(loaded: LoadedSpec, root: Node) -> LoadedSpec:
    """Return the spec of a file that held a changed document.

    See `nrs_design.spec.edits.changed`; a `SpecError` if that is no valid spec.
    """
    return _loaded(loaded.path, loaded.text, root, ())


def _loaded(file: Path, text: str, root: Node, syntax: tuple[Fault, ...]) -> LoadedSpec:
    spec = _validate(root, syntax, file)
    sha256 = hash_meaning(to_data(root))
    return LoadedSpec(path=file, sha256=sha256, text=text, spec=spec, parsed=root)


def is_there(path: Path) -> bool:
    """Tell whether a spec, or an axis of one, exists; an axis of a file that is not valid does."""
    file = file_of(path)
    if not file.is_file():
        return False
    try:
        return file == path or path in axes_at(file)
    except SpecError:
        return True


def load_spec(path: str | os.PathLike[str]) -> Spec:
    """Read and validate a spec file, and return what it says; see :func:`read_spec`."""
    return read_spec(path).spec


def parse_spec(text: str, path: Path | None = None) -> Spec:
    """Validate the text of a spec.

    A `SpecError` with line, column, message and remedy; the path is named in it.
    """
    return _validate(*parse_with_faults(text, path), path)


def model_of(kind: str) -> type[Any]:
    """Return the model of a kind of spec; a command pays only for the kind that it reads."""
    module, name = _MODELS[kind]
    found: type[Any] = getattr(import_module(f"nrs_design.spec.{module}"), name)
    return found


def _validate(root: Node, syntax: tuple[Fault, ...], path: Path | None) -> Spec:
    if is_task_space(root):
        raise SpecError(
            "this text holds several axes", path=path, remedy="read the file with #AXIS behind it"
        )
    spec: Spec = _validated(model_of(_kind_of(root, path, syntax)), root, syntax, path)
    return spec


def _validated(model: type[Any], root: Node, syntax: tuple[Fault, ...], path: Path | None) -> Any:
    found: tuple[Fault, ...] = ()
    said = to_data(root)
    with axis_context(said.get("axis") if isinstance(said, dict) else None):
        try:
            spec = model.model_validate(said)
        except ValidationError as error:
            found = file_faults(error, model, root)
    if syntax or found:
        raise _refusal(syntax, found, path)
    return spec


def _refusal(syntax: tuple[Fault, ...], found: tuple[Fault, ...], path: Path | None) -> SpecError:
    """Join the faults; what cannot be read as YAML is wrong in itself, and reported once."""
    known = {(fault.line, fault.column) for fault in syntax}
    others = (fault for fault in found if (fault.line, fault.column) not in known)
    return SpecError.combine((*syntax, *others), path)


def _kind_of(root: Node, path: Path | None, syntax: tuple[Fault, ...]) -> str:
    """Return the kind of a spec, which decides how the rest of the file is read."""

    def refuse(message: str, remedy: str, node: Node) -> SpecError:
        place = node.position
        return _refusal(syntax, (Fault(message, place.line, place.column, remedy),), path)

    if not isinstance(root, Mapping):
        raise refuse("a spec is a mapping of keys", "start with `kind: ...`", root)
    kind = root.entries.get("kind")
    if kind is None and {"schema", "verdict"} <= root.entries.keys():
        raise SpecError(
            "this is a certificate, not a spec",
            path=path,
            remedy="name the spec that it is for; nrs-design verify CERT reads certificates, "
            "and what an assumption bounds and how to test it is in the report of a spec alone",
        )
    if kind is None:
        raise refuse("`kind` is missing", f"add `kind: ` with one of {', '.join(SPEC_KINDS)}", root)
    if not isinstance(kind, Scalar):
        raise refuse("kind: expected a single text", "write one value", kind)
    if kind.text not in SPEC_KINDS:
        message = f"kind: {quoted(kind.text)} is not known"
        raise refuse(message, did_you_mean(kind.text, SPEC_KINDS), kind)
    return kind.text
