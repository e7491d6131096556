"""From a file to a validated spec."""

from __future__ import annotations

import hashlib
import json
import os
from dataclasses import dataclass
from pathlib import Path

from pydantic import ValidationError

from nrs_design.errors import SpecError
from nrs_design.spec.document import Mapping, Node, Scalar, parse_document, read_text, to_data
from nrs_design.spec.exact import quoted
from nrs_design.spec.faults import did_you_mean, spec_error
from nrs_design.spec.interaction import InteractionDesignSpec
from nrs_design.spec.robot import RobotSpec
from nrs_design.spec.switched_system import SwitchedSystemSpec

Spec = InteractionDesignSpec | SwitchedSystemSpec | RobotSpec

KINDS: dict[str, type[Spec]] = {
    "interaction-design": InteractionDesignSpec,
    "switched-system": SwitchedSystemSpec,
    "robot": RobotSpec,
}


@dataclass(frozen=True)
class LoadedSpec:
    """A spec together with the file that it came from.

    Parameters
    ----------
    path : Path
        The file, as it was named.
    sha256 : str
        Hash of what the file says, in hexadecimal; see `hash_meaning`.
    text : str
        The file's text.
    spec : InteractionDesignSpec, SwitchedSystemSpec or RobotSpec
        What it says.
    """

    path: Path
    sha256: str
    text: str
    spec: Spec


def read_spec(path: str | os.PathLike[str]) -> LoadedSpec:
    """Read and validate a spec file.

    Parameters
    ----------
    path : path-like
        A YAML file; the name ``*.nrs.yaml`` is a convention, not a condition.

    Returns
    -------
    LoadedSpec
        The spec, its text and the hash of what it says.

    Raises
    ------
    SpecError
        With path, line, column, message and remedy, if anything about the file is wrong.
    """
    file = Path(path)
    _, text = read_text(file)
    root = parse_document(text, file)
    return LoadedSpec(file, hash_meaning(root), text, _validate(root, file))


def load_spec(path: str | os.PathLike[str]) -> Spec:
    """Read and validate a spec file, and return what it says; see :func:`read_spec`."""
    return read_spec(path).spec


def parse_spec(text: str, path: Path | None = None) -> Spec:
    """Validate the text of a spec.

    Parameters
    ----------
    text : str
        YAML text.
    path : Path, optional
        Named in errors.

    Raises
    ------
    SpecError
        With line, column, message and remedy.
    """
    return _validate(parse_document(text, path), path)


def hash_meaning(root: Node) -> str:
    """Return the SHA-256 of what a document says, in hexadecimal.

    Two documents share it exactly if they have the same keys in the same order and the same
    texts: comments, line ends, quotes and layout do not count. A spec is read from these texts and
    from nothing else. Order counts because modes are numbered in the order of the controllers.
    """
    canonical = json.dumps(to_data(root), separators=(",", ":"), ensure_ascii=True)
    return hashlib.sha256(canonical.encode()).hexdigest()


def _validate(root: Node, path: Path | None) -> Spec:
    model = KINDS[_kind_of(root, path)]
    try:
        return model.model_validate(to_data(root))
    except ValidationError as error:
        raise spec_error(error, model, root, path) from None


def _kind_of(root: Node, path: Path | None) -> str:
    if not isinstance(root, Mapping):
        raise _kind_error("a spec is a mapping of keys", "start with `kind: ...`", root, path)
    kind = root.entries.get("kind")
    if kind is None:
        remedy = f"add `kind: ` with one of {', '.join(KINDS)}"
        raise _kind_error("`kind` is missing", remedy, root, path)
    if not isinstance(kind, Scalar):
        raise _kind_error("kind: expected a single text", "write one value", kind, path)
    if kind.text not in KINDS:
        message = f"kind: {quoted(kind.text)} is not known"
        raise _kind_error(message, did_you_mean(kind.text, KINDS), kind, path)
    return kind.text


def _kind_error(message: str, remedy: str, node: Node, path: Path | None) -> SpecError:
    place = node.position
    return SpecError(message, path=path, line=place.line, column=place.column, remedy=remedy)
