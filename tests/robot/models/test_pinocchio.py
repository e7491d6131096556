"""Full dynamics against Pinocchio, an implementation that is not ours."""

import numpy as np
import pytest

from benchmarks.pinocchio_tree import Tree
from nrs_design.robot.models.dynamics import inverse_dynamics
from tests.robot.models.crooked import crooked


def poses(count, seed):
    rng = np.random.default_rng(seed)
    low, high = (-0.24, -0.33, 0.155), (0.24, 0.33, 0.24)
    return rng.uniform(low, high, (count, 3)), rng.normal(0, 2, (2, count, 3))


@pytest.fixture(params=["neuroboscope", "tilted", "crooked"])
def tree(request, robot):
    robots = {"neuroboscope": robot, "tilted": robot.tilted(-0.5), "crooked": crooked(robot)}
    return Tree(robots[request.param])


def test_loops_are_closed(tree):
    for pose in poses(20, 1)[0]:
        assert tree.gap(tree.configuration(pose)) < 1e-12


def test_closed_loop_inverse_dynamics(tree):
    positions, (velocities, accelerations) = poses(40, 2)
    ours = inverse_dynamics(tree.robot, positions, velocities, accelerations)
    theirs = [tree.torque(*each) for each in zip(positions, velocities, accelerations, strict=True)]
    assert np.abs(ours - theirs).max() < 1e-9
