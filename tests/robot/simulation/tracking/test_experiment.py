from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.errors import PoseError
from nrs_design.robot.simulation.tracking import Experiment, thesis_experiments

MILLIMETER, DEGREE = 1e-3, np.pi / 180


def poses(experiment, *times):
    return experiment.motion(np.array(times))[0]


def test_depth_of_4_20(robot):
    depth = thesis_experiments(robot, "computed-torque")[0]
    wanted = [[0, 0, d * MILLIMETER] for d in (200, 200, 250, 200, 150, 200)]
    assert poses(depth, 0, 10, 12.5, 15, 17.5, 20) == pytest.approx(np.array(wanted), abs=1e-12)
    assert depth.duration == pytest.approx(20)


@pytest.mark.parametrize("controller", ["computed-torque", "independent-joint"])
def test_angles_of_4_21_4_22_4_34_and_4_35(robot, controller):
    _, phi, psi = thesis_experiments(robot, controller)
    assert poses(phi, 3, 12.5, 17.5) == pytest.approx(
        np.array([[0, 0, 0.15], [15 * DEGREE, 0, 0.15], [-15 * DEGREE, 0, 0.15]]), abs=1e-12
    )
    assert poses(psi, 3, 12.5, 17.5) == pytest.approx(
        np.array([[0, 0, 0.15], [0, 20 * DEGREE, 0.15], [0, -20 * DEGREE, 0.15]]), abs=1e-12
    )


def test_depth_of_4_33c_is_slow_if_the_print_is_literal(robot):
    depth = thesis_experiments(robot, "independent-joint")[0]
    assert poses(depth, 30)[0, 2] == pytest.approx(0.2 + 0.05 * np.sin(0.0571 * 20))
    assert depth.duration == pytest.approx(10 + 110.04, abs=0.01)


def test_balanced_robot_of_4_37_to_4_39(robot):
    depth, phi, psi = thesis_experiments(robot, "balanced")
    assert poses(depth, 30)[0] == pytest.approx([0, 0, 0.2 + 0.05 * np.sin(0.0571 * 20)])
    assert poses(phi, 30)[0] == pytest.approx([15 * DEGREE * np.sin(0.0571 * 20), 0, 0.2])
    assert poses(psi, 30)[0] == pytest.approx([0, 20 * DEGREE * np.sin(0.0571 * 20), 0.2])


def test_a_period_of_ones_own(robot):
    for controller in ("computed-torque", "independent-joint", "balanced"):
        lengths = {one.duration for one in thesis_experiments(robot, controller, 4.0)}
        assert lengths == {14.0}


def test_another_workspace_scales_the_motions(robot):
    small = replace(robot, workspace=replace(robot.workspace, phi=0.1, d=(0.16, 0.22)))
    depth, phi, _ = thesis_experiments(small, "computed-torque")
    assert poses(depth, 12.5)[0] == pytest.approx([0, 0, 0.22])
    assert poses(phi, 12.5)[0] == pytest.approx([0.1, 0, 0.16])


@given(moved=st.sampled_from(["d", "phi", "psi"]), time=st.floats(10.01, 14.9))
def test_velocity_and_acceleration_are_derivatives(moved, time):
    experiment = Experiment(moved, (0.01, 0.02, 0.2), 0.04, 1.3)
    h = 1e-4
    (before, now, after), (_, v, _), (_, _, _) = experiment.motion(
        np.array([time - h, time, time + h])
    )
    a = experiment.motion(np.array([time]))[2][0]
    assert (after - before) / (2 * h) == pytest.approx(v, abs=1e-8)
    assert (after - 2 * now + before) / h**2 == pytest.approx(a, abs=1e-7)


def test_reference_of_the_joints_is_that_of_the_pose(robot):
    depth = thesis_experiments(robot, "computed-torque")[0]
    wanted = depth.reference(robot, np.array([0.0, 12.5, 17.5]))
    # Reference values: theta3 at d = 200, 250 and 150 mm.
    assert np.degrees(wanted.position[:, 2]) == pytest.approx(
        [21.967097, 39.241659, 3.822554], abs=1e-6
    )
    assert np.all(wanted.velocity[0] == 0)
    assert np.all(wanted.acceleration[0] == 0)


def test_out_of_reach(robot):
    far = Experiment("d", (0.0, 0.0, 0.3), 0.1, 1.0)
    with pytest.raises(PoseError, match="overstretched"):
        far.reference(robot, np.linspace(10, 17, 50))
