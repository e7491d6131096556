"""Inverse dynamics of many poses at once, beside loops over one pose at a time."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin

from benchmarks.measure import Comparison, Size, time_side_by_side
from benchmarks.pinocchio_tree import Array, Tree
from nrs_design.robot.models.dynamics import inverse_dynamics
from nrs_design.robot.models.geometry import posture
from nrs_design.robot.models.motion import joint_driven
from nrs_design.robot.models.robot import build_robot
from nrs_design.spec import RobotSpec, load_spec

SPEC = Path(__file__).parents[1] / "specs" / "robots" / "neuroboscope.nrs.yaml"
POSES, FEWEST = 100_000, 1_000
# What takes a millisecond for each pose is measured on so many, and scaled.
FEW = 1_000
TARGET = 20.0


def run(size: Size) -> tuple[Comparison, ...]:
    """Measure 100,000 poses against three loops."""
    spec = load_spec(SPEC)
    assert isinstance(spec, RobotSpec)
    robot, poses = build_robot(spec), size.pick(POSES, POSES, FEWEST)
    tree = Tree(robot)
    pose, velocity, acceleration = _motions(poses)
    few = (pose[:FEW], velocity[:FEW], acceleration[:FEW])
    q, v, a = _tree_motions(tree, pose, velocity, acceleration)
    (rnea, closed, single, ours), results = time_side_by_side(
        size.pick(5, 1, 1),
        lambda: _loop_over_rnea(tree, q, v, a),
        lambda: [tree.torque(*each) for each in zip(*few, strict=True)],
        lambda: [inverse_dynamics(robot, *each) for each in zip(*few, strict=True)],
        lambda: inverse_dynamics(robot, pose, velocity, acceleration),
    )
    theirs, alone, torque = (np.asarray(result) for result in results[1:])
    from_pin = f"torques differ by at most {np.abs(theirs - torque[:FEW]).max():.1e} N m"
    from_one = f"torques differ by at most {np.abs(alone - torque[:FEW]).max():.1e} N m"
    scaled = poses / FEW
    work = f"inverse dynamics, {poses:,} poses"
    given = "the angles and rates of all 12 joints are given, the loops stay cut"
    return (
        Comparison(work, "loop: pin.rnea of the tree alone", rnea, ours, TARGET, given),
        Comparison(
            work, "loop: closed-loop dynamics by pin", scaled * closed, ours, TARGET, from_pin
        ),
        Comparison(work, "loop: ours, pose by pose", scaled * single, ours, TARGET, from_one),
    )


def _motions(poses: int) -> tuple[Array, Array, Array]:
    rng = np.random.default_rng(1)
    pose = rng.uniform((-0.24, -0.33, 0.155), (0.24, 0.33, 0.24), (poses, 3))
    return pose, rng.normal(0, 1, (poses, 3)), rng.normal(0, 5, (poses, 3))


def _tree_motions(
    tree: Tree, pose: Array, velocity: Array, acceleration: Array
) -> tuple[Array, Array, Array]:
    """Angles, velocities and accelerations of all joints of the tree; shapes (n, 12)."""
    legs = joint_driven(posture(tree.robot, pose), velocity, acceleration).legs
    v = [(g.alpha_1, g.beta_1, g.kappa_1 - g.beta_1, g.gamma_1 - g.kappa_1) for g in legs]
    a = [(g.alpha_2, g.beta_2, g.kappa_2 - g.beta_2, g.gamma_2 - g.kappa_2) for g in legs]
    return tree.configuration(pose), _joined(v), _joined(a)


def _joined(legs: list[tuple[Array, ...]]) -> Array:
    return np.stack([joint for leg in legs for joint in leg], axis=-1)


def _loop_over_rnea(tree: Tree, q: Array, v: Array, a: Array) -> Array:
    torques = np.empty_like(q)
    for i in range(len(q)):
        torques[i] = pin.rnea(tree.model, tree.data, q[i], v[i], a[i])
    return torques
