"""A spec from matrices that live in a program: the same spec that a file would give."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from nrs_design.api.exact import is_state_space, read_number, read_rows, time_of
from nrs_design.errors import SpecError
from nrs_design.proof.text import exact_text
from nrs_design.spec import LoadedSpec, SwitchedSystemSpec
from nrs_design.spec.document import hash_meaning, parse_document
from nrs_design.spec.places import file_faults

Document = dict[str, Any]


def spec_of_matrices(
    modes: Sequence[object] | Mapping[str, object],
    *,
    name: str,
    time: str | None = None,
    dwell_time: object = None,
    longest_dwell_time: object = None,
    transitions: Sequence[tuple[str, str]] | None = None,
    resets: Mapping[tuple[str, str], object] | None = None,
    parameters: Mapping[str, object] | None = None,
) -> LoadedSpec:
    """Return the spec of a switched system whose matrices are given; see `nrs_design.certify`."""
    matrices = name_modes(modes)
    axis = time_of(list(matrices.values()), time)
    unit = "s" if axis == "continuous" else "steps"
    times = {"dwell_time": dwell_time, "longest_dwell_time": longest_dwell_time}
    uncertain = bool(parameters)
    document: Document = {
        "kind": "switched-system",
        "name": name,
        "time": str(axis),
        "modes": [
            {"name": str(label), "A": _entries(A, str(label), uncertain)}
            for label, A in matrices.items()
        ],
        "switching": _switching(times, transitions, unit),
    }
    if parameters:
        document["parameters"] = {key: _parameter(value) for key, value in parameters.items()}
    if resets:
        document["resets"] = list(_resets(resets))
    return _validated(document, name)


def name_modes(modes: Sequence[object] | Mapping[str, object]) -> dict[str, object]:
    """Return modes by name: m1, m2, ... where they have no names."""
    if isinstance(modes, str | Path):
        remedy = "nrs_design.load(path).certify() is for the file of a spec"
        raise SpecError("the modes are a text, not a list of matrices", remedy=remedy)
    if isinstance(modes, Mapping):
        matrices = dict(modes)
    elif is_state_space(modes) or _depth(modes) == 2:
        raise SpecError("the modes are one matrix", remedy="put it into a list: [A]")
    elif not isinstance(modes, Iterable):
        raise SpecError("the modes are not a list of matrices", remedy="write [A1, A2]")
    else:
        matrices = {f"m{index + 1}": mode for index, mode in enumerate(modes)}
    if not matrices:
        raise SpecError("no modes are given", remedy="give at least one matrix")
    return matrices


def _entries(matrix: object, label: str, uncertain: bool) -> list[list[str]]:
    """Return entries as the texts of a spec; with parameters, texts may be expressions."""
    if uncertain and isinstance(matrix, list | tuple) and not is_state_space(matrix):
        return [[_entry(entry, label) for entry in row] for row in matrix]
    return _texts(read_rows(matrix, f"mode {label}"))


def _entry(entry: object, label: str) -> str:
    return entry if isinstance(entry, str) else exact_text(read_number(entry, f"mode {label}"))


def _texts(rows: Sequence[Sequence[Fraction]]) -> list[list[str]]:
    return [[exact_text(entry) for entry in row] for row in rows]


def _resets(resets: Mapping[tuple[str, str], object]) -> Iterator[Document]:
    """Yield what a spec says of resets."""
    known = isinstance(resets, Mapping)
    if not known or any(not isinstance(key, tuple) or len(key) != 2 for key in resets):
        raise SpecError(
            "a reset is named by two modes", remedy="write resets={('from', 'to'): matrix}"
        )
    for (source, target), maps in resets.items():
        for G in _several(maps):
            rows = _texts(read_rows(G, f"the reset {source}-{target}"))
            yield {"from": str(source), "to": str(target), "map": rows}


def _several(maps: object) -> list[object]:
    """Return the matrices of all resets between two modes."""
    if isinstance(maps, list | tuple) and maps and _depth(maps[0]) == 2:
        return list(maps)
    return [maps]


def _depth(value: object) -> int:
    """Return how deep lists or arrays are nested: 1 for a row, 2 for a matrix."""
    dimensions = getattr(value, "ndim", None)
    if dimensions is not None:
        return int(dimensions)
    return 1 + _depth(value[0]) if isinstance(value, list | tuple) and value else 0


def _switching(
    times: Mapping[str, object], transitions: Sequence[tuple[str, str]] | None, unit: str
) -> object:
    rules: Document = {
        key: _dwell_times(value, key, unit) for key, value in times.items() if value is not None
    }
    if transitions is not None:
        # A text is no pair: the validation refuses it.
        rules["transitions"] = [
            pair if isinstance(pair, str) else [*map(str, pair)] for pair in transitions
        ]
    return rules or "arbitrary"


def _dwell_times(value: object, key: str, unit: str) -> object:
    """Return one time as the text of a spec, or one for each of some modes."""
    if isinstance(value, Mapping):
        return {str(name): _dwell_times(time, key, unit) for name, time in value.items()}
    is_text = isinstance(value, str) and " " in value
    return value if is_text else f"{exact_text(read_number(value, key))} {unit}"


def _parameter(value: object) -> Document:
    """Return the section of a spec on a parameter, from its fields or its two ends."""
    if isinstance(value, Mapping):
        return {
            key: [exact_text(read_number(end)) for end in entry]
            if key == "range"
            else (entry if key == "varies" else exact_text(read_number(entry)))
            for key, entry in value.items()
        }
    if not isinstance(value, Sequence) or isinstance(value, str) or len(value) != 2:
        raise SpecError(
            "a parameter is given by two ends", remedy="write parameters={'k': (lowest, highest)}"
        )
    low, high = (read_number(end) for end in value)
    return {"nominal": exact_text((low + high) / 2), "range": [exact_text(low), exact_text(high)]}


def _validated(document: Document, name: str) -> LoadedSpec:
    """Validate a document; JSON is YAML, so its text is a spec file, too."""
    text = json.dumps(document, indent=1) + "\n"
    try:
        spec = SwitchedSystemSpec.model_validate(document)
    except ValidationError as error:
        found = file_faults(error, SwitchedSystemSpec, parse_document(text))
        # Drop line numbers: they refer to a generated text that the user never sees.
        faults = tuple(replace(fault, line=None, column=None) for fault in found)
        raise SpecError.combine(faults, None) from None
    return LoadedSpec(
        path=Path(f"{name}.nrs.yaml"), sha256=hash_meaning(document), text=text, spec=spec
    )
