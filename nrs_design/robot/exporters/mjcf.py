"""A robot for MuJoCo: the model, and what it leaves out."""

from __future__ import annotations

from nrs_design.robot.exporters.robot_tree import RobotExport, xml_comment
from nrs_design.robot.models import LEAST, robot_model

_LINES = (
    f"added: {LEAST} kg m^2 to the inertia of every link about every axis, and {LEAST} kg to links "
    "without mass, which MuJoCo does not take",
    "closed loops: each side arm is joined to the middle arm at two points of the endoscope axis; "
    "MuJoCo holds such joints with some compliance, see solref",
    "start from the key frame home: with all joints at zero the loops are open",
)


def render(export: RobotExport) -> dict[str, bytes]:
    """Return the file of a robot, by its ending."""
    head = xml_comment(export, "mjcf", _LINES)
    return {".mjcf.xml": (head + robot_model(export.robot, export.loaded.spec.name)).encode()}
