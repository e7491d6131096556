"""From the spec of a robot to the robot."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from nrs_design.pipeline.design import placed, wrong_kind
from nrs_design.spec import LoadedSpec, read_spec

if TYPE_CHECKING:
    from nrs_design.robot.models.robot import Robot
    from nrs_design.spec import RobotSpec


def run_robot(path: Path) -> tuple[LoadedSpec, RobotSpec, Robot]:
    """Read a robot spec and build the robot."""
    from nrs_design.robot.models.robot import build_robot

    loaded = read_spec(path)
    if loaded.spec.kind != "robot":
        raise wrong_kind(
            loaded,
            f"a spec of kind {loaded.spec.kind} describes no robot",
            "name a spec of kind robot; `nrs-design init robot` writes one",
        )
    with placed(loaded):
        return loaded, loaded.spec, build_robot(loaded.spec)
