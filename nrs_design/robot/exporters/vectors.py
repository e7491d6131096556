"""Conformance vectors of a robot's laws: exactly what a step makes of inputs and states."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from nrs_design import __version__
from nrs_design.controllers.operations import StepLaw
from nrs_design.exporters.formats.vectors import law_document, make_vectors, vector_rows
from nrs_design.ownership import MARK
from nrs_design.robot.exporters.c import UNPROVED, laws_of
from nrs_design.robot.exporters.robot_tree import RobotExport

SCHEMA = "nrs-design/robot-vectors/1"
COUNT = 500


def render(export: RobotExport) -> dict[str, bytes]:
    """Return the vectors of all laws, by their ending.

    Parameters
    ----------
    export : RobotExport
        With a spec that has `control`.

    Raises
    ------
    DesignError
        If the spec lacks something, or its numbers contradict each other.
    """
    return {".robot-vectors.json": text(export, laws_of(export)).encode()}


def text(export: RobotExport, laws: Mapping[str, StepLaw], count: int = COUNT) -> str:
    """Return the JSON document.

    Parameters
    ----------
    export : RobotExport
        Of which robot.
    laws : mapping of str to StepLaw
        By the end of their names in C.
    count : int
        Cases for each.
    """
    head = {
        "schema": SCHEMA,
        "about": [
            f"nrs-design {__version__}",
            f"spec: {export.loaded.spec.name}, sha256 {export.loaded.sha256}",
            f"verdict: UNPROVED: {UNPROVED}",
        ],
        "origin": f"{MARK}{export.origin}",
        "numbers": "valid as an integer, all others as bits of IEEE 754 single precision, big end "
        "first, in hexadecimal",
        "laws": {name: _document(law, count) for name, law in laws.items()},
    }
    return json.dumps(head, indent=1) + "\n"


def _document(law: StepLaw, count: int) -> dict[str, Any]:
    vectors = make_vectors(law, count)
    cases = [" ".join(map(str, row)) for row in vector_rows(vectors)]
    return law_document(law, vectors) | {"cases": cases}
