"""The same run on an engine that others wrote: MuJoCo moves what the commands move.

The law, its sensors and delays, and the tissue are those of the sampled engine, so that only the
mechanics differs. A robot is the MJCF that `robot export` writes, with its closed loops; one axis
is a hinge. The drives are put in as armature, damping and dry friction of the driven joints, and
tissue pushes through ``qfrc_applied``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib import import_module
from typing import Any
from xml.etree import ElementTree

import numpy as np

from nrs_design.errors import DesignError
from nrs_design.models.plant import Plant
from nrs_design.robot.models import DRIVEN, robot_model, tree_angles
from nrs_design.robot.models.vectors import Array
from nrs_design.robot.simulation.robot_body import FASTEST, Arm, drive_torques, place, runs_away
from nrs_design.simulation.sampled_axis import SampledAxis

# Longest step of MuJoCo in s.
STEP = 1e-4
HINGE = """\
<mujoco model="axis">
  <compiler angle="radian" autolimits="false"/>
  <option integrator="implicitfast" gravity="0 0 0"/>
  <worldbody>
    <body name="rotor">
      <inertial pos="0 0 0" mass="1" diaginertia="1e-12 1e-12 1e-12"/>
      <joint name="axis" axis="0 0 1"/>
    </body>
  </worldbody>
  <actuator><motor name="axis" joint="axis"/></actuator>
</mujoco>
"""


def load_mujoco() -> Any:
    """Return MuJoCo.

    Raises
    ------
    DesignError
        If it is not installed.
    """
    try:
        return import_module("mujoco")
    except ImportError as error:
        raise DesignError(
            f"the engine needs MuJoCo, which cannot be loaded ({error})",
            remedy="pip install 'nrs-design[mujoco]', or use --engine sampled",
        ) from None


class MujocoBody:
    """A hinge, or a robot with its closed loops, stepped by MuJoCo.

    Parameters
    ----------
    axes : sequence of SampledAxis
        At rest: one, or theta1 to theta3 of a robot.
    plant : Plant
        The drives.
    arm : Arm, optional
        The robot; by default a hinge.
    step : float
        Longest step in s.

    Raises
    ------
    DesignError
        If MuJoCo is not installed.
    PoseError
        If the robot cannot reach its pose of rest.
    """

    def __init__(
        self,
        axes: Sequence[SampledAxis],
        plant: Plant,
        arm: Arm | None = None,
        step: float = STEP,
    ) -> None:
        self.engine, self.step, self.loaded = load_mujoco(), step, plant.load_inertia is not None
        robot = arm is not None
        names = tuple(DRIVEN.values()) if robot else ("axis",)
        text = HINGE if arm is None else robot_model(arm.robot, "robot")
        friction = [axis.scenario.errors.friction for axis in axes]
        compensated = arm is None or not arm.holds
        text = _driven(text, plant, dict(zip(names, friction, strict=True)), step, compensated)
        self.model = self.engine.MjModel.from_xml_string(text)
        self.data = self.engine.MjData(self.model)
        self.dofs = [self.model.joint(name).dofadr[0] for name in names]
        *_, self.torque = drive_torques(plant)
        self.rest = np.zeros(1) if arm is None else arm.joints
        self.held = np.zeros(1) if arm is None else arm.held
        start = [axis.theta for axis in axes] if arm is None else tree_angles(arm.robot, arm.rest)
        self.data.qpos[:] = start

    def move(self, axes: Sequence[SampledAxis], commands: Sequence[float], width: float) -> None:
        """Step until the next sample; see `nrs_design.simulation.processor.AbstractBody`.

        Parameters
        ----------
        axes, commands, width
            As there.

        Raises
        ------
        DesignError
            If it moves beyond all bounds.
        """
        model, data = self.model, self.data
        count = int(np.ceil(width / self.step - 1e-9))
        model.opt.timestep = width / count
        data.ctrl[:] = self.torque * np.array(commands)
        for _ in range(count):
            data.qfrc_applied[self.dofs] = self.held - self._push(axes)
            self.engine.mj_step(model, data)
            # Beyond every number MuJoCo would write a log of its own.
            if not np.abs(data.qvel).max() < FASTEST:
                raise runs_away()
            place(axes, data.qpos[self.dofs] - self.rest, data.qvel[self.dofs], width / count)

    def _push(self, axes: Sequence[SampledAxis]) -> Array:
        """Return the torque of tissue that the drives carry."""
        if not self.loaded:
            return np.zeros(len(axes))
        return np.array([axis.tissue.torque(axis.theta, axis.omega) for axis in axes])


def _driven(
    text: str, plant: Plant, friction: Mapping[str, float], step: float, compensated: bool
) -> str:
    """Return a model with the drives at its driven joints, by their names.

    MuJoCo's dry friction is a constraint that gives way, and so are closed loops: they are made as
    stiff as the step allows.
    """
    inertia, damping, torque = drive_torques(plant)
    root, stiff = ElementTree.fromstring(text), f"{2 * step!r} 1"
    for joint in root.iter("joint"):
        name = joint.get("name", "")
        if name in friction:
            joint.set("armature", repr(float(joint.get("armature", "0")) + inertia))
            joint.set("damping", repr(damping))
            joint.set("frictionloss", repr(torque * friction[name]))
            joint.set("solreffriction", stiff)
            joint.set("solimpfriction", "0.9999 0.9999")
    for loop in root.iter("connect"):
        loop.set("solref", stiff)
    option = root.find("option")
    if compensated and option is not None:
        option.set("gravity", "0 0 0")
    return ElementTree.tostring(root, encoding="unicode")
