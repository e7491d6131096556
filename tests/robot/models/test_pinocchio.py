"""Full dynamics against Pinocchio, an implementation that is not ours."""

import numpy as np
import pinocchio as pin
import pytest

from benchmarks.pinocchio_tree import Tree
from nrs_design.robot.models import inverse_dynamics, mass_matrix, posture
from nrs_design.robot.models.motion import joint_driven
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


def test_rates_of_all_joints(tree):
    positions, (velocities, accelerations) = poses(10, 3)
    for x, v, a in zip(positions, velocities, accelerations, strict=True):
        motion = joint_driven(posture(tree.robot, x), v, a)
        ours = np.array(
            [
                [
                    [leg.alpha_1, leg.beta_1, leg.kappa_1 - leg.beta_1, leg.gamma_1 - leg.kappa_1],
                    [leg.alpha_2, leg.beta_2, leg.kappa_2 - leg.beta_2, leg.gamma_2 - leg.kappa_2],
                ]
                for leg in motion.legs
            ]
        )
        theirs = tree.full_motion(tree.configuration(x), v, a)
        assert np.concatenate(ours[:, 0]) == pytest.approx(theirs[0], abs=1e-9)
        assert np.concatenate(ours[:, 1]) == pytest.approx(theirs[1], abs=1e-8)


def test_kinetic_energy_of_the_tree(tree):
    positions, (velocities, _) = poses(10, 4)
    for x, v in zip(positions, velocities, strict=True):
        q = tree.configuration(x)
        rates, _ = tree.full_motion(q, v, 0 * v)
        energy = pin.computeKineticEnergy(tree.model, tree.data, q, rates)
        assert v @ mass_matrix(tree.robot, x) @ v / 2 == pytest.approx(energy, rel=1e-9)
