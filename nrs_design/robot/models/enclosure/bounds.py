"""The file of bounds of a robot: computed, and shown again."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from math import degrees, inf, pi, radians
from typing import Any

import numpy as np

from nrs_design.errors import DesignError
from nrs_design.progress import Progress, silent
from nrs_design.proof.bounds import lower, upper
from nrs_design.robot.models.enclosure.enclose import Enclosed, Goal, enclose, find_largest
from nrs_design.robot.models.enclosure.quantities import QUANTITIES, RobotQuantity
from nrs_design.robot.models.geometry import is_reachable, unreachable
from nrs_design.robot.models.robot import Robot, Workspace
from nrs_design.robot.models.workspace import workspace_grid
from nrs_design.spec.exact import parse_exact
from nrs_design.spec.robot_bounds import SCHEMA, UNITS, content_id

# What is shown is at most this times what is found at a pose. Velocity torques take second
# derivatives of the loops: to come as near as the others would take much longer.
ROOM = 1.02
ROOMS: Mapping[str, float] = {"velocity_torques": 1.35}
# Of a sampled value, which is computed in floating point.
ROUNDING = 1e-9
# In SI, of a quantity that is zero, such as gravity in space: no enclosure is exactly that.
NOTHING = 1e-9
DIGITS = 5


@dataclass(frozen=True)
class Space:
    """A workspace as it is written down: degrees and millimetres, in decimals."""

    phi: str
    psi: str
    d: tuple[str, str]

    @classmethod
    def of(cls, workspace: Workspace) -> Space:
        """Write down a workspace, to ten digits."""
        low, high = (f"{1e3 * end:.10g}" for end in workspace.d)
        return cls(f"{degrees(workspace.phi):.10g}", f"{degrees(workspace.psi):.10g}", (low, high))

    @property
    def workspace(self) -> Workspace:
        """In rad and m."""
        phi, psi, low, high = (float(parse_exact(t)) for t in (self.phi, self.psi, *self.d))
        return Workspace(radians(phi), radians(psi), (low / 1e3, high / 1e3))

    def fields(self) -> dict[str, Any]:
        """Return it for the file."""
        return {"phi_deg": self.phi, "psi_deg": self.psi, "d_mm": list(self.d)}


def compute_bounds(
    robot: Robot,
    space: Space,
    budget: float = inf,
    progress: Progress = silent,
) -> dict[str, Enclosed]:
    """Enclose all that a certificate of coupled axes asks of a robot.

    Parameters
    ----------
    robot : Robot
        The robot.
    space : Space
        The poses.
    budget : float
        Work for each quantity, in units.
    progress : callable
        Told what is being done.

    Raises
    ------
    PoseError
        If a leg cannot reach one of the poses.
    DesignError
        If the work did not suffice to show something.
    ClockError
        If the clock stopped it.
    """
    _refuse_unreachable(robot, space)
    found = {}
    for key, quantity in QUANTITIES.items():
        found[key] = enclose(
            robot,
            quantity,
            space.workspace,
            goal_of(ROOMS.get(key, ROOM)),
            budget,
            progress,
        )
        if not found[key].cover.reached:
            raise _undecided(found[key])
    return found


def confirm_bounds(
    robot: Robot,
    document: Mapping[str, Any],
    budget: float = inf,
    progress: Progress = silent,
) -> Iterator[str]:
    """Show the bounds of a file again; yield what is wrong with them.

    Parameters
    ----------
    robot : Robot
        Whose bounds they are said to be.
    document : mapping
        The file.
    budget : float
        Work for each quantity, in units.
    progress : callable
        Told what is being done.

    Raises
    ------
    PoseError
        If a leg cannot reach one of the poses.
    DesignError
        If the work did not suffice to decide something.
    ClockError
        If the clock stopped it.
    """
    space = space_of(document)
    _refuse_unreachable(robot, space)
    for key, quantity, goal in _claimed(document):
        shown = enclose(robot, quantity, space.workspace, goal_of(0.0, goal), budget, progress)
        if shown.found > goal * (1 + ROUNDING):
            yield _exceeded(key, quantity, shown.found, shown.pose)
        elif not shown.cover.reached:
            raise _undecided(shown)


def contradict_bounds(
    robot: Robot, document: Mapping[str, Any], progress: Progress = silent
) -> Iterator[str]:
    """Look for poses that exceed the bounds of a file, in seconds; yield what is wrong with them.

    Where nothing is wrong, nothing is shown either: `confirm_bounds` shows them.

    Parameters
    ----------
    robot : Robot
        Whose bounds they are said to be.
    document : mapping
        The file.
    progress : callable
        Told what is being done.

    Raises
    ------
    PoseError
        If a leg cannot reach one of the poses.
    """
    space = space_of(document)
    _refuse_unreachable(robot, space)
    for key, quantity, goal in _claimed(document):
        progress(f"{quantity.name}: looking for the largest value")
        found, pose = find_largest(robot, quantity, space.workspace)
        if found > goal * (1 + ROUNDING):
            yield _exceeded(key, quantity, found, pose)


def _claimed(document: Mapping[str, Any]) -> Iterator[tuple[str, RobotQuantity, float]]:
    """Yield what the bounds of a file claim of each quantity; no float above that will do."""
    for key, quantity in QUANTITIES.items():
        claimed = parse_exact(document["bounds"][key])
        if key == "lightest":
            if not claimed:
                # Nothing is claimed by zero: no motion of a mass has less.
                continue
            claimed = 1 / claimed
        goal = float(claimed)
        yield (
            key,
            quantity,
            float(np.nextafter(goal, -inf)) if Fraction(goal) > claimed else goal,
        )


def _exceeded(
    key: str, quantity: RobotQuantity, found: float, pose: tuple[float, float, float]
) -> str:
    said = _pose_words(quantity, found, pose)
    return f"{key.replace('_', ' ')}: {said} exceeds the bound in the file"


def goal_of(room: float, least: float = NOTHING) -> Goal:
    """Return how near a bound shall come to what was found: that much times it, or the least.

    Parameters
    ----------
    room : float
        At least 1, or 0 for the least alone.
    least : float
        Where next to nothing was found, in the unit of the bound.
    """
    return lambda found: max(room * found, least)


def space_of(document: Mapping[str, Any]) -> Space:
    """Return the workspace of a file of bounds."""
    said = document["workspace"]
    low, high = said["d_mm"]
    return Space(said["phi_deg"], said["psi_deg"], (low, high))


def bounds_document(
    name: str, sha256: str, space: Space, found: Mapping[str, Enclosed], version: str
) -> dict[str, Any]:
    """Return the file of bounds, every number rounded to its safe side.

    Parameters
    ----------
    name, sha256 : str
        The robot, and the hash of its spec.
    space : Space
        The poses.
    found : mapping
        As `compute_bounds` gives it.
    version : str
        Of this package.
    """
    document: dict[str, Any] = {
        "schema": SCHEMA,
        "robot": {"name": name, "sha256": sha256},
        "workspace": space.fields(),
        "bounds": {key: bound_text(key, item) for key, item in found.items()},
        "units": dict(UNITS),
        "found": {
            key: {
                "value": f"{value_of(key, item.found):.6g}",
                "phi_deg": f"{degrees(item.pose[0]):.6g}",
                "psi_deg": f"{degrees(item.pose[1]):.6g}",
                "d_mm": f"{1e3 * item.pose[2]:.6g}",
                "boxes": item.cover.boxes.count,
            }
            for key, item in found.items()
        },
        "package": {"name": "nrs-design", "version": version},
    }
    return document | {"id": content_id(document)}


def bound_text(key: str, item: Enclosed) -> str:
    """Return a bound, rounded to its safe side."""
    bound = Fraction(item.bound)
    return lower(1 / bound, DIGITS) if key == "lightest" else upper(bound, DIGITS)


def value_of(key: str, number: float) -> float:
    """Return the number that a user knows: for mobility, the eigenvalue itself."""
    return 1 / number if key == "lightest" else number


def pose_text(item: Enclosed) -> str:
    """Say what was found, and where."""
    return _pose_words(item.quantity, item.found, item.pose)


def _pose_words(quantity: RobotQuantity, found: float, pose: tuple[float, float, float]) -> str:
    phi, psi, d = pose
    value = f"{found:.6g} {quantity.unit}"
    return (
        f"{quantity.name} {value} at phi {degrees(phi):.4g} deg, psi {degrees(psi):.4g} deg, "
        f"d {1e3 * d:.4g} mm"
    )


def _refuse_unreachable(robot: Robot, space: Space) -> None:
    workspace = space.workspace
    # The boxes are of sines, which no longer grow from there on.
    if not (0 < workspace.phi < pi / 2 and 0 < workspace.psi < pi / 2):
        raise DesignError(
            f"no bounds of |phi| <= {space.phi} deg, |psi| <= {space.psi} deg",
            remedy="give angles between 0 and 90 deg (--phi, --psi)",
            at=("workspace",),
        )
    poses = workspace_grid(replace(robot, workspace=workspace)).reshape(-1, 3)
    if not np.all(is_reachable(robot, poses)):
        raise unreachable(robot, poses)


def _undecided(item: Enclosed) -> DesignError:
    cover = item.cover
    left = int(np.sum(~(cover.bounds <= cover.goal)))
    return DesignError(
        f"no bound of {item.quantity.name} was shown with the work that was allowed: "
        f"{left} boxes of poses are left; found so far: {pose_text(item)}",
        remedy="narrow the workspace where a leg is nearly stretched or folded (--phi, --psi, "
        "--depth), or raise --budget",
        at=("workspace",),
    )
