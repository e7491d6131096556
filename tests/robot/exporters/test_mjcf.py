"""The robot in MuJoCo, with closed loops, beside our own dynamics."""

import os
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from nrs_design.robot.exporters.mjcf import render
from nrs_design.robot.exporters.robot_tree import RobotExport
from nrs_design.robot.models import (
    gravity_torque,
    inverse_kinematics,
    joint_names,
    mass_matrix,
    tree_angles,
)
from tests.robot.exporters.robots import POSES

# Nothing is drawn.
os.environ["MUJOCO_GL"] = "disable"
mujoco = pytest.importorskip("mujoco", reason="MuJoCo is not installed")


def load(robot, loaded):
    text = render(RobotExport(loaded, robot, "a.nrs.yaml"))[".mjcf.xml"].decode()
    return mujoco.MjModel.from_xml_string(text)


def at(model, robot, pose):
    """The chains closed at a pose, at rest."""
    data = mujoco.MjData(model)
    data.qpos[:] = tree_angles(robot, pose)
    mujoco.mj_forward(model, data)
    return data


def gap(model, data):
    """Largest distance of two points that are to be one."""
    sites = {model.site(i).name: data.site_xpos[i] for i in range(model.nsite)}
    return max(
        np.linalg.norm(sites[f"{side}_{point}"] - sites[f"middle_{point}"])
        for side in ("left", "right")
        for point in ("near", "far")
    )


def projection(model, data):
    """Velocities of all joints for unit velocities of the driven ones."""
    names = [model.joint(i).name for i in range(model.njnt)]
    driven = [names.index(motor) for motor in ("left_plane", "right_plane", "middle_crank")]
    rows = np.reshape(data.efc_J, (-1, model.nv))
    assert len(rows) == 12
    # The robot is overconstrained: three of the rows say what others say.
    matrix = np.vstack([rows, np.eye(model.nv)[driven]])
    right = np.vstack([np.zeros((12, 3)), np.eye(3)])
    found, *_ = np.linalg.lstsq(matrix, right, rcond=1e-10)
    assert np.abs(matrix @ found - right).max() < 1e-10
    return found


def test_joints_and_loops(robot, loaded):
    model = load(robot, loaded)
    assert [model.joint(i).name for i in range(model.njnt)] == joint_names(robot)
    assert (model.njnt, model.neq, model.nu) == (12, 4, 3)
    for pose in POSES:
        assert gap(model, at(model, robot, pose)) < 1e-12


def test_mass_and_gravity_agree_with_our_dynamics(robot, loaded):
    model = load(robot, loaded)
    for pose in POSES:
        data = at(model, robot, pose)
        T = projection(model, data)
        momenta = np.zeros((model.nv, 3))
        for k in range(3):
            momentum = np.zeros(model.nv)
            mujoco.mj_mulM(model, data, momentum, T[:, k].copy())
            momenta[:, k] = momentum
        assert np.abs(T.T @ momenta - mass_matrix(robot, pose)).max() < 1e-9
        assert np.abs(T.T @ data.qfrc_bias - gravity_torque(robot, pose)).max() < 1e-9


def test_the_loops_hold_while_it_moves(robot, loaded):
    """From the key frame, against gravity but for the holding torque: it hardly moves."""
    model = load(robot, loaded)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    assert gap(model, data) < 1e-12
    data.ctrl[:] = gravity_torque(robot, robot.home)
    for _ in range(100):
        mujoco.mj_step(model, data)
    assert gap(model, data) < 1e-4
    driven = [data.joint(name).qpos[0] for name in ("left_plane", "right_plane", "middle_crank")]
    assert driven == pytest.approx(inverse_kinematics(robot, robot.home), abs=1e-3)


def test_the_comment(robot, loaded):
    text = render(RobotExport(loaded, robot, "a.nrs.yaml"))[".mjcf.xml"].decode()
    head, _, _ = text.partition("-->")
    for fact in (loaded.sha256, "nothing is proved", "units: SI", "theta3 = middle_crank", "home"):
        assert fact in head
    assert ET.fromstring(text).tag == "mujoco"
