"""A robot for MuJoCo, with its closed loops."""

from __future__ import annotations

from collections.abc import Iterator

from nrs_design.robot.models.robot import Leg, Robot
from nrs_design.robot.models.tree import DRIVEN, Link, attribute_text, links_of, tree_angles

# MuJoCo takes no moving body without mass, or without inertia about one of its axes.
LEAST = 1e-12
# Where two axes are joined a second time, from the first point on, in m.
APART = 0.1


def robot_model(robot: Robot, name: str) -> str:
    """Return the robot as MJCF: without motors, friction, springs and contacts.

    Parameters
    ----------
    robot : Robot
        The robot.
    name : str
        Of the model.
    """
    return "".join(_document(robot, name))


def _document(robot: Robot, name: str) -> Iterator[str]:
    yield f'<mujoco model="{name}">\n'
    yield '  <compiler angle="radian" autolimits="false"/>\n'
    gravity = attribute_text(*robot.gravity_vector)
    yield f'  <option timestep="0.001" integrator="implicitfast" gravity="{gravity}"/>\n'
    yield '  <default><geom contype="0" conaffinity="0" size="0.006"/></default>\n'
    yield "  <worldbody>\n"
    for leg in robot.legs:
        yield from _leg(robot, leg)
    yield "  </worldbody>\n  <equality>\n"
    for leg in robot.legs[:2]:
        for point in ("near", "far"):
            sites = f'site1="{leg.name}_{point}" site2="middle_{point}"'
            yield f'    <connect {sites} solref="0.004 1"/>\n'
    yield "  </equality>\n  <actuator>\n"
    for theta, joint in DRIVEN.items():
        yield f'    <motor name="{theta}" joint="{joint}"/>\n'
    yield "  </actuator>\n  <keyframe>\n"
    yield f'    <key name="home" qpos="{attribute_text(*tree_angles(robot, robot.home))}"/>\n'
    yield "  </keyframe>\n</mujoco>\n"


def _leg(robot: Robot, leg: Leg) -> Iterator[str]:
    links, indent = links_of(robot, leg), "    "
    for depth, link in enumerate(links):
        space = indent + 2 * depth * " "
        # The plane of a leg is no body of its own: its inertia is that of a joint of the crank.
        x, y, _ = leg.axis
        place = (link.offset * x, link.offset * y, 0.0) if depth == 0 else (link.offset, 0.0, 0.0)
        turned = f' xyaxes="{attribute_text(*leg.axis, 0.0, 0.0, 1.0)}"' if depth == 0 else ""
        yield f'{space}<body name="{link.name}" pos="{attribute_text(*place)}"{turned}>\n'
        if depth == 0:
            armature = f'armature="{attribute_text(leg.axis_inertia)}"'
            yield f'{space}  <joint name="{leg.name}_plane" axis="1 0 0" {armature}/>\n'
        yield f'{space}  <joint name="{link.name}" axis="0 0 1"/>\n'
        yield f"{space}  {_inertial(link)}\n"
        yield f'{space}  <geom type="capsule" fromto="0 0 0 {attribute_text(link.length)} 0 0"/>\n'
    yield from _sites(leg, indent + 6 * " ")
    for depth in reversed(range(len(links))):
        yield f"{indent}{2 * depth * ' '}</body>\n"


def _sites(leg: Leg, space: str) -> Iterator[str]:
    """Yield two points of the endoscope axis, which runs along -y in the frame of an arm."""
    for name, y in (("near", 0.0), ("far", -APART)):
        yield f'{space}<site name="{leg.name}_{name}" pos="{attribute_text(leg.l3, y, 0.0)}"/>\n'


def _inertial(link: Link) -> str:
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = link.inertia
    tensor = attribute_text(xx + LEAST, yy + LEAST, zz + LEAST, xy, xz, yz)
    mass = attribute_text(max(link.mass, LEAST))
    return f'<inertial pos="{attribute_text(*link.center)}" mass="{mass}" fullinertia="{tensor}"/>'
