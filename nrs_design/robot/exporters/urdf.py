"""A robot as URDF, which knows no closed loops: the open chains, and what is lost with them."""

from __future__ import annotations

from collections.abc import Iterator
from math import pi

from nrs_design.robot.exporters.robot_tree import RobotExport, home_joints, xml_comment
from nrs_design.robot.models import Leg, Robot, attribute_text, links_of, tree_angles

_LOSS = (
    "LOST: the closed loops. URDF describes trees, so the three legs are open chains: the frames "
    "left_tip and right_tip are not held at middle_tip, all 12 joints move freely instead of 3, "
    "and mass and gravity of the chains are not those of the robot until the loops are closed; "
    "there, the tips coincide and their y axes are parallel.",
)
_ZERO = "0 0 0"


def render(export: RobotExport) -> dict[str, bytes]:
    """Return the file of a robot, by its ending."""
    return {".urdf": "".join(_document(export)).encode()}


def _document(export: RobotExport) -> Iterator[str]:
    robot = export.robot
    lines = (
        *_LOSS,
        f"gravity: {robot.gravity!r} m/s^2, which URDF does not hold, along -z of world; the base "
        "is tilted by theta4",
        "closed in the middle of the workspace: "
        f"{attribute_text(*tree_angles(robot, robot.home))}, "
        f"with theta1 to theta3 {attribute_text(*home_joints(robot))}",
    )
    yield '<?xml version="1.0"?>\n'
    yield xml_comment(export, "urdf", lines)
    yield f'<robot name="{export.loaded.spec.name}">\n'
    yield '  <link name="world"/>\n  <link name="base"/>\n'
    tilt = attribute_text(0.0, robot.base_tilt, 0.0)
    yield _joint("base_tilt", "fixed", "world", "base", _ZERO, tilt)
    for leg in robot.legs:
        yield from _leg(robot, leg)
    yield "</robot>\n"


def _leg(robot: Robot, leg: Leg) -> Iterator[str]:
    plane, parent = f"{leg.name}_plane", f"{leg.name}_plane_link"
    tensor = ((leg.axis_inertia, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    yield _link(parent, 0.0, (0.0, 0.0, 0.0), tensor)
    # x along the base axis, y along z of the base.
    turned = attribute_text(pi / 2, 0.0, leg.azimuth)
    yield _joint(plane, "continuous", "base", parent, _ZERO, turned, "1 0 0")
    for link in links_of(robot, leg):
        child = f"{link.name}_link"
        yield _link(child, link.mass, link.center, link.inertia)
        place = attribute_text(link.offset, 0.0, 0.0)
        yield _joint(link.name, "continuous", parent, child, place, _ZERO, "0 0 1")
        parent = child
    yield f'  <link name="{leg.name}_tip"/>\n'
    place = attribute_text(leg.l3, 0.0, 0.0)
    yield _joint(f"{leg.name}_end", "fixed", parent, f"{leg.name}_tip", place, _ZERO)


def _link(
    name: str, mass: float, center: tuple[float, ...], inertia: tuple[tuple[float, ...], ...]
) -> str:
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = inertia
    entries = {"ixx": xx, "ixy": xy, "ixz": xz, "iyy": yy, "iyz": yz, "izz": zz}
    tensor = " ".join(f'{key}="{attribute_text(value)}"' for key, value in entries.items())
    return (
        f'  <link name="{name}">\n    <inertial>\n'
        f'      <origin xyz="{attribute_text(*center)}"/>\n'
        f'      <mass value="{attribute_text(mass)}"/>\n'
        f"      <inertia {tensor}/>\n    </inertial>\n  </link>\n"
    )


def _joint(
    name: str, kind: str, parent: str, child: str, xyz: str, rpy: str, axis: str | None = None
) -> str:
    turns = "" if axis is None else f'    <axis xyz="{axis}"/>\n'
    return (
        f'  <joint name="{name}" type="{kind}">\n'
        f'    <parent link="{parent}"/>\n    <child link="{child}"/>\n'
        f'    <origin xyz="{xyz}" rpy="{rpy}"/>\n{turns}  </joint>\n'
    )
