"""Bounds on what the links of a robot do to its axes: a file that is computed once from its spec.

``nrs-design robot bounds`` writes it, beside the spec of the robot: ``arm.bounds.json`` beside
``arm.nrs.yaml``. It is read with every spec that names the robot.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

from nrs_design.errors import SpecError
from nrs_design.files import open_regular, read_json_text
from nrs_design.proof.text import quoted
from nrs_design.spec.document import Position, parse_document, read_source, to_data
from nrs_design.spec.exact import parse_exact
from nrs_design.spec.fields import HASH_PATTERN, NAME_PATTERN
from nrs_design.spec.meaning import hash_meaning

SCHEMA = "nrs-design/robot-bounds/1"
# How assumptions say that bounds are these: whoever reads a spec does not compute them.
ON_TRUST = "taken on trust from the file of bounds"
SUFFIX = ".bounds.json"
SPEC_SUFFIX = ".nrs.yaml"
MAX_BYTES = 2**20
REMEDY = "make it with `nrs-design robot bounds {robot} --write`"
# In which the numbers of a file are.
UNITS = {
    "lightest": "kg*m^2",
    "heaviest": "kg*m^2",
    "velocity_torques": "N*m*s^2/rad^2",
    "gravity_gradient": "N*m/rad",
}


@dataclass(frozen=True, slots=True)
class RobotBounds:
    """What holds in all poses of a workspace of a robot, in SI units."""

    # name, sha256: the robot, and the hash of what its spec says.
    name: str
    sha256: str
    workspace: str  # In words
    # lightest, heaviest: every eigenvalue of the matrix of inertia of the links is between them.
    lightest: Fraction
    heaviest: Fraction
    # Coriolis and centrifugal torques are at most this times the square of the speed.
    velocity_torques: Fraction
    gravity_gradient: Fraction  # Norm of the derivative of the torques of gravity
    id: str  # SHA-256 of what the file says


def bounds_file(robot: Path) -> Path:
    """Return the file of the bounds of a robot, beside its spec."""
    return robot.with_name(robot.name.removesuffix(SPEC_SUFFIX) + SUFFIX)


def content_id(document: Mapping[str, Any]) -> str:
    """Return the SHA-256 of what the file says, its id left out."""
    content = {key: value for key, value in document.items() if key != "id"}
    canonical = json.dumps(content, sort_keys=True, separators=(",", ":"), ensure_ascii=True)
    return hashlib.sha256(canonical.encode()).hexdigest()


def read_bounds(file: Path) -> tuple[RobotBounds, Mapping[str, Any]]:
    """Read a file of bounds.

    Returns
    -------
    RobotBounds
        What it says.
    mapping
        The whole document.

    Raises
    ------
    SpecError
        If it is missing, or is no such file, or has been altered, or names a pose that exceeds one
        of its bounds.
    """
    remedy = REMEDY.format(robot=file.name.removesuffix(SUFFIX) + SPEC_SUFFIX)
    try:
        with open_regular(file) as stream:
            document = json.loads(read_json_text(stream.read(MAX_BYTES)))
        if document["schema"] != SCHEMA:
            raise ValueError(f"its schema is not {SCHEMA}")
        if document["id"] != content_id(document):
            raise ValueError("its id is not that of its content: it has been altered")
        if document["units"] != UNITS:
            raise ValueError("its units are not those of SI")
        _check_workspace(document["workspace"])
        robot, bounds = document["robot"], document["bounds"]
        light, heavy, turning, weight = (parse_exact(bounds[key]) for key in UNITS)
        if min(light, turning, weight) < 0 or light > heavy:
            raise ValueError("a bound is negative, or the lightest is above the heaviest")
        _check_found(bounds, document["found"])
        found = RobotBounds(
            name=_matching(robot["name"], NAME_PATTERN),
            sha256=_matching(robot["sha256"], HASH_PATTERN),
            workspace=workspace_text(document),
            lightest=light,
            heaviest=heavy,
            velocity_torques=turning,
            gravity_gradient=weight,
            id=document["id"],
        )
    except OSError as error:
        raise SpecError(
            f"the bounds of the robot cannot be read ({error.strerror})", path=file, remedy=remedy
        ) from error
    except (SpecError, ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise SpecError(f"not bounds of a robot: {error}", path=file, remedy=remedy) from error
    return found, document


def _matching(text: str, pattern: str) -> str:
    """Return a name or a hash that stands in the sentences of a certificate, if it is one."""
    if not re.fullmatch(pattern, text):
        raise ValueError(f"{quoted(text)} is no name or hash of a robot")
    return text


def _check_workspace(space: Mapping[str, Any]) -> None:
    phi, psi, low, high = map(parse_exact, (space["phi_deg"], space["psi_deg"], *space["d_mm"]))
    if not (0 < phi < 90 and 0 < psi < 90 and 0 < low < high):
        raise ValueError("its angles are not between 0 and 90 deg, or its depths are no range")


def _check_found(bounds: Mapping[str, Any], found: Mapping[str, Any]) -> None:
    for key in UNITS:
        bound, value = parse_exact(bounds[key]), parse_exact(found[key]["value"])
        if value < bound if key == "lightest" else value > bound:
            raise ValueError(
                f"{key.replace('_', ' ')} is said to be bounded by {bounds[key]}, and "
                f"{found[key]['value']} was found at a pose"
            )


def workspace_text(document: Mapping[str, Any]) -> str:
    """Say over which poses bounds hold."""
    space = document["workspace"]
    phi, psi, (low, high) = space["phi_deg"], space["psi_deg"], space["d_mm"]
    return f"|phi| <= {phi} deg, |psi| <= {psi} deg, d from {low} to {high} mm"


def read_robot_bounds(spec: Path, named: str, at: Position) -> RobotBounds:
    """Read the bounds of the robot that a spec names.

    Parameters
    ----------
    spec : Path
        The file of the spec.
    named : str
        The robot's file, relative to that.
    at : Position
        Where it is named.

    Raises
    ------
    SpecError
        If there is no such robot, or its bounds are missing, altered, or those of another robot.
    """
    robot = spec.parent / named
    if Path(named).is_absolute() or not robot.is_file():
        raise SpecError(
            f"there is no robot spec {quoted(named)} relative to this file",
            path=spec,
            line=at.line,
            column=at.column,
            remedy="name the file of a spec of kind robot, such as ../robots/arm.nrs.yaml",
        )
    bounds, _ = read_bounds(bounds_file(robot))
    if (bounds.name, bounds.sha256) != identity_of(robot):
        raise SpecError(
            f"the robot {quoted(named)} has changed since its bounds were computed",
            path=spec,
            line=at.line,
            column=at.column,
            remedy=f"compute them anew: nrs-design robot bounds {robot} --write",
        )
    return bounds


def identity_of(robot: Path) -> tuple[str, str]:
    """Return the name of a robot and the hash of what its spec says, right or wrong."""
    said = to_data(parse_document(read_source(robot)[1], robot))
    name = said.get("name") if isinstance(said, dict) else None
    return str(name), hash_meaning(said)
