"""What the commands of the sampled law move: the links of a robot, or what MuJoCo makes of them."""

from __future__ import annotations

from collections.abc import Sequence

from nrs_design.errors import DesignError
from nrs_design.models.plant import Plant
from nrs_design.robot.simulation.mujoco_body import MujocoBody
from nrs_design.robot.simulation.robot_body import Arm, RobotBody
from nrs_design.simulation.bodies import MUJOCO
from nrs_design.simulation.processor import AbstractBody
from nrs_design.simulation.sampled_axis import SampledAxis


def body_of(
    axes: Sequence[SampledAxis], plant: Plant, arm: Arm | None, engine: str
) -> AbstractBody:
    """Return what an engine moves.

    Parameters
    ----------
    axes : sequence of SampledAxis
        One, or those of theta1 to theta3.
    plant : Plant
        Of each of them.
    arm : Arm or None
        The robot of three axes.
    engine : {"sampled", "mujoco"}
        The sampled engine needs a robot; MuJoCo moves one axis, too.

    Raises
    ------
    DesignError
        If commands take effect later than at once: these bodies take them at their sample.
    """
    if any(axis.late[1] for axis in axes):
        raise DesignError(
            "latency and dead time are simulated for the motor of one axis alone",
            remedy="use --engine sampled without a robot, or leave latency and dead_time out",
            at=("sampling", "latency"),
        )
    if engine == MUJOCO:
        return MujocoBody(axes, plant, arm)
    assert arm is not None, "one axis of the sampled engine is a motor"
    return RobotBody(arm, plant, axes)
