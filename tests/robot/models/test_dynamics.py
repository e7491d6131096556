"""Properties of the full dynamics; its values are in `test_pinocchio`."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given

from nrs_design.errors import DesignError
from nrs_design.robot.models.body import MASSLESS, point_mass
from nrs_design.robot.models.correction import simplified_dynamics
from nrs_design.robot.models.dynamics import (
    coriolis_matrix,
    gravity_torque,
    inverse_dynamics,
    mass_and_bias,
    mass_matrix,
    potential_energy,
    torque_shares,
)
from nrs_design.robot.models.geometry import PoseError
from nrs_design.robot.models.kinematics import jacobian, orientation, orientation_jacobian
from nrs_design.robot.models.robot import Workspace
from nrs_design.robot.models.workspace import examine_inertia

from .strategies import poses, rates, tilts


@given(pose=poses)
def test_mass_matrix_is_symmetric_and_positive_definite(robot, pose):
    M = mass_matrix(robot, pose)
    assert pytest.approx(M.T, abs=1e-15) == M
    assert np.linalg.eigvalsh(M).min() > 1e-3


@given(pose=poses, velocity=rates, acceleration=rates, tilt=tilts)
def test_torque_is_the_sum_of_its_parts(robot, pose, velocity, acceleration, tilt):
    robot = robot.tilted(tilt)
    M, C = mass_matrix(robot, pose), coriolis_matrix(robot, pose, velocity)
    G = gravity_torque(robot, pose)
    torque = inverse_dynamics(robot, pose, velocity, acceleration)
    assert M @ acceleration + C @ velocity + G == pytest.approx(torque, abs=1e-12)
    again, bias = mass_and_bias(robot, pose, velocity)
    assert again == pytest.approx(M, abs=1e-15)
    assert bias == pytest.approx(C @ velocity + G, abs=1e-12)


@given(pose=poses, velocity=rates)
def test_rate_of_mass_less_twice_coriolis_is_skew(robot, pose, velocity):
    along = jacobian(robot, pose) @ velocity
    h = 1e-5
    rate = (mass_matrix(robot, pose + h * along) - mass_matrix(robot, pose - h * along)) / (2 * h)
    skew = rate - 2 * coriolis_matrix(robot, pose, velocity)
    assert skew == pytest.approx(-skew.T, abs=1e-6)


@given(pose=poses, tilt=tilts)
def test_gravity_is_the_slope_of_the_potential(robot, pose, tilt):
    robot, h = robot.tilted(tilt), 1e-6
    J = jacobian(robot, pose)
    slopes = [
        (potential_energy(robot, pose + h * column) - potential_energy(robot, pose - h * column))
        / (2 * h)
        for column in J.T
    ]
    assert gravity_torque(robot, pose) == pytest.approx(slopes, abs=1e-7)


def test_batch_is_pose_by_pose(robot):
    rng = np.random.default_rng(3)
    pose = rng.uniform((-0.24, -0.33, 0.155), (0.24, 0.33, 0.24), (10_000, 3))
    velocity, acceleration = rng.normal(0, 2, (2, 10_000, 3))
    batch = inverse_dynamics(robot, pose, velocity, acceleration)
    for i in range(0, 10_000, 997):
        alone = inverse_dynamics(robot, pose[i], velocity[i], acceleration[i])
        assert batch[i] == pytest.approx(alone, abs=1e-12)
    C = coriolis_matrix(robot, pose[:5], velocity[:5])
    assert C[4] == pytest.approx(coriolis_matrix(robot, pose[4], velocity[4]), abs=1e-14)


def test_rotor_of_the_middle_actuator_counts(robot):
    # Without it the torques of thesis 3.3.1 are off in the sixth digit.
    from dataclasses import replace

    middle = replace(robot.legs[2], axis_inertia=0.0)
    without = replace(robot, legs=(*robot.legs[:2], middle))
    change = mass_matrix(robot, robot.home) - mass_matrix(without, robot.home)
    assert change[:2, :2] == pytest.approx(np.full((2, 2), 14.81e-7 / 2), rel=1e-9)


def test_gravity_turns_with_the_base(robot):
    # Thesis 3.40: a negative tilt raises the +x side.
    x, y, z = robot.tilted(np.radians(-30)).gravity_vector
    assert (x, y, z) == pytest.approx((-9.81 / 2, 0, -9.81 * np.sqrt(3) / 2))


def test_shares_add_up(robot):
    shares = torque_shares(robot, [[0, 0, 0.2], [0.1, -0.2, 0.2]])
    assert shares.gravity + shares.coriolis + shares.inertia == pytest.approx(np.ones((2, 3)))
    assert min(part.min() for part in (shares.gravity, shares.coriolis, shares.inertia)) >= 0


def test_at_rest_all_is_gravity(robot):
    shares = torque_shares(robot, robot.home, (0, 0, 0), (0, 0, 0))
    assert shares.means == (1, 0, 0)


def test_weightless_and_slow_all_is_inertia(robot):
    from dataclasses import replace

    shares = torque_shares(replace(robot, gravity=0.0), robot.home, (0, 0, 0), (1, 1, 1))
    assert shares.means == (0, 0, 1)


def only_platform(robot):
    left, right, middle = robot.remove_links().legs
    rotor = replace(middle, axis_inertia=robot.legs[2].axis_inertia)
    return replace(robot, legs=(left, right, rotor))


@given(pose=poses, tilt=tilts)
def test_it_is_the_full_model_without_links(robot, pose, tilt):
    robot = robot.tilted(tilt)
    model, bare = simplified_dynamics(robot, pose), only_platform(robot)
    assert pytest.approx(mass_matrix(bare, pose), abs=1e-15) == model.Ms
    assert pytest.approx(gravity_torque(bare, pose), abs=1e-13) == model.Gs


@given(pose=poses)
def test_as_the_thesis_writes_it(robot, pose):
    # Thesis 3.31 to 3.35, with the angular velocity of 3.33 as printed.
    x, y, d = orientation(pose)
    Rx = np.array([[1, 0, 0], [0, np.cos(x), -np.sin(x)], [0, np.sin(x), np.cos(x)]])
    Ry = np.array([[np.cos(y), 0, np.sin(y)], [0, 1, 0], [-np.sin(y), 0, np.cos(y)]])
    R = Rx @ Ry
    J = orientation_jacobian(pose) @ jacobian(robot, pose)
    L = np.array([0.0367, 0.0, d + 0.010])
    linear = np.column_stack([np.cross((1, 0, 0), R @ L), np.cross(R[:, 1], R @ L), R[:, 2]]) @ J
    angular = np.diag([1.0, 1.0, 0.0]) @ J
    rod = 0.7972 * 0.25**2 / 12
    inertia = R @ np.diag([rod, rod, 0]) @ R.T + np.diag([14.81e-7, 0, 0])
    Ms = 0.7972 * linear.T @ linear + angular.T @ inertia @ angular
    assert simplified_dynamics(robot, pose, printed=True).Ms == pytest.approx(Ms, abs=1e-14)


def test_eigenvalues_of_the_robot(robot):
    found = examine_inertia(robot)
    assert (np.diff(found) > 0).all()
    M = mass_matrix(robot, robot.home)
    assert [found.sum(), found.prod()] == pytest.approx([np.trace(M), np.linalg.det(M)])


def test_the_platform_alone_is_enough(robot):
    assert (examine_inertia(robot.remove_links()) > 0).all()


def test_nothing_with_mass(robot):
    with pytest.raises(DesignError, match="is singular"):
        examine_inertia(replace(robot.remove_links(), platform=MASSLESS))


def test_a_mass_that_one_motion_leaves_at_rest(robot):
    # In the pivot: turning the endoscope about it moves nothing.
    at_pivot = point_mass(1.0, (0.0, 0.0, -float(robot.home[2])))
    with pytest.raises(DesignError, match="moves no mass"):
        examine_inertia(replace(robot.remove_links(), platform=at_pivot))


def test_a_workspace_out_of_reach(robot):
    far = Workspace(robot.workspace.phi, robot.workspace.psi, (0.5, 0.6))
    with pytest.raises(PoseError, match="overstretched"):
        examine_inertia(replace(robot, workspace=far))
