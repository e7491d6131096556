"""The spanning tree in Pinocchio; with the loops closed there, it is our robot."""

import xml.etree.ElementTree as ET

import numpy as np
import pytest

from nrs_design.robot.exporters.robot_tree import RobotExport
from nrs_design.robot.exporters.urdf import render
from nrs_design.robot.models import gravity_torque, joint_names, mass_matrix, tree_angles
from tests.robot.exporters.robots import POSES

pin = pytest.importorskip("pinocchio", reason="Pinocchio is not installed")
DRIVEN = ("left_plane", "right_plane", "middle_crank")


def text_of(robot, loaded):
    return render(RobotExport(loaded, robot, "a.nrs.yaml"))[".urdf"].decode()


def load(robot, loaded):
    model = pin.buildModelFromXML(text_of(robot, loaded))
    model.gravity.linear = np.array([0, 0, -robot.gravity])
    return model


def configuration(model, robot, pose):
    """Pinocchio holds a continuous joint as cosine and sine."""
    angles = dict(zip(joint_names(robot), tree_angles(robot, pose), strict=True))
    q = pin.neutral(model)
    for name, angle in angles.items():
        at = model.joints[model.getJointId(name)].idx_q
        q[at : at + 2] = np.cos(angle), np.sin(angle)
    return q


def closure(model, data, q):
    """Rows that are zero where the side tips stay at the middle one, and their y axes parallel."""
    pin.computeJointJacobians(model, data, q)
    pin.updateFramePlacements(model, data)
    tips = [model.getFrameId(f"{name}_tip") for name in ("left", "right", "middle")]
    J = [pin.getFrameJacobian(model, data, tip, pin.LOCAL_WORLD_ALIGNED) for tip in tips]
    across = data.oMf[tips[2]].rotation[:, [0, 2]].T
    rows = [J[side][:3] - J[2][:3] for side in (0, 1)]
    rows += [across @ (J[side][3:] - J[2][3:]) for side in (0, 1)]
    places = [data.oMf[tip] for tip in tips]
    apart = [np.linalg.norm(places[side].translation - places[2].translation) for side in (0, 1)]
    turned = [np.cross(places[i].rotation[:, 1], places[2].rotation[:, 1]) for i in (0, 1)]
    return np.vstack(rows), max(*apart, *map(np.linalg.norm, turned))


def test_it_is_a_tree_of_twelve_joints(robot, loaded):
    model = load(robot, loaded)
    assert sorted(list(model.names)[1:]) == sorted(joint_names(robot))
    assert (model.nv, model.nq) == (12, 24)


def test_closed_it_agrees_with_our_dynamics(robot, loaded):
    model = load(robot, loaded)
    data = model.createData()
    driven = [model.joints[model.getJointId(name)].idx_v for name in DRIVEN]
    for pose in POSES:
        q = configuration(model, robot, pose)
        J, gap = closure(model, data, q)
        assert gap < 1e-12
        matrix = np.vstack([J, np.eye(12)[driven]])
        right = np.vstack([np.zeros((len(J), 3)), np.eye(3)])
        T, *_ = np.linalg.lstsq(matrix, right, rcond=1e-10)
        assert np.abs(matrix @ T - right).max() < 1e-10
        M = pin.crba(model, data, q)
        M = np.triu(M) + np.triu(M, 1).T
        assert np.abs(T.T @ M @ T - mass_matrix(robot, pose)).max() < 1e-9
        G = pin.computeGeneralizedGravity(model, data, q)
        assert np.abs(T.T @ G - gravity_torque(robot, pose)).max() < 1e-9


def test_the_loss_is_said_inside(robot, loaded):
    text = text_of(robot, loaded)
    head, _, _ = text.partition("-->")
    for fact in (loaded.sha256, "nothing is proved", "LOST: the closed loops", "m/s^2, which URDF"):
        assert fact in head
    assert ET.fromstring(text).tag == "robot"
