"""The robot of the thesis, as every row of chapters 3 and 4 takes it."""

from __future__ import annotations

from functools import cache

from nrs_design.robot.models.robot import Robot, build_robot
from nrs_design.spec import RobotSpec, parse_spec
from nrs_design.spec.templates import TEMPLATES


@cache
def robot_spec() -> RobotSpec:
    """Return the spec that `nrs-design init robot` writes."""
    spec = parse_spec(TEMPLATES["robot"])
    assert isinstance(spec, RobotSpec)
    return spec


@cache
def robot() -> Robot:
    """Return the robot on a level base."""
    return build_robot(robot_spec())
