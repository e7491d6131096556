"""What a format of a robot is rendered from, and what every such file says first."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from nrs_design import __version__
from nrs_design.ownership import MARK
from nrs_design.printable import printable
from nrs_design.robot.models import DRIVEN, Robot, inverse_kinematics
from nrs_design.spec import LoadedSpec


@dataclass(frozen=True, slots=True)
class RobotExport:
    """What a format of a robot is rendered from."""

    loaded: LoadedSpec  # Where it comes from
    robot: Robot  # What it says
    origin: str  # Where its spec is, seen from the file; see `nrs_design.ownership`


def home_joints(robot: Robot) -> list[float]:
    """Return theta1 to theta3 in the middle of the workspace, in rad."""
    return [float(angle) for angle in inverse_kinematics(robot, robot.home)]


def xml_comment(export: RobotExport, format_: str, lines: Sequence[str]) -> str:
    """Return the comment that a file begins with, as XML.

    Parameters
    ----------
    export : RobotExport
        With the spec.
    format_ : str
        Its name.
    lines : sequence of str
        What is to be said besides.
    """
    spec = export.loaded.spec
    text = [
        f"nrs-design {format_} of {spec.name}, nrs-design {__version__}",
        f"spec: {spec.name}, sha256 {export.loaded.sha256}",
        f"{MARK}{export.origin}",
        "verdict: none, this is a model of a robot, and nothing is proved of it",
        "units: SI, angles in rad; base frame with its origin in the pivot, x towards the middle "
        "leg, z along the endoscope at phi = psi = 0",
        f"driven joints: {', '.join(f'{theta} = {name}' for theta, name in DRIVEN.items())}",
        "left out: motors, friction, springs and counter-masses of the balance, limits of joints, "
        "contacts",
        *lines,
    ]
    # Two hyphens would end a comment.
    return "<!-- " + "\n     ".join(map(printable, text)).replace("--", "- -") + " -->\n"
