"""Three axes on the links of a robot; MuJoCo says the same in `test_mujoco_body`."""

from dataclasses import replace

import numpy as np
import pytest

from nrs_design.errors import DesignError, PoseError
from nrs_design.progress import silent
from nrs_design.robot.models import gravity_torque, mass_matrix
from nrs_design.robot.models.body import MASSLESS
from nrs_design.robot.simulation.robot_body import Arm, RobotBody
from nrs_design.simulation.processor import Motors, run_axes
from tests.simulation.interactions import axes_of, text_of

RUN = (
    "command: {sinusoid: {amplitude: 7 deg/s, frequency: 1 Hz}}, duration: 0.1 s, "
    "surfaces: [{environment: soft, at: 0.05 deg}], control: {fixed: withdrawal}"
)


def text(scenario=RUN, inertia="1.213"):
    return text_of(scenario=scenario).replace(
        "0.0351 s}", f"0.0351 s, load_inertia: {inertia} kg*m^2}}"
    )


def run(body, scenario=RUN, inertia="1.213"):
    plant, axes = axes_of(text(scenario, inertia), 3)
    return run_axes(axes, body(axes, plant), "sampled", 10**6, silent)


def test_links_without_mass_leave_every_axis_alone(robot):
    arm = Arm(replace(robot.without_links(), platform=MASSLESS), robot.home)
    together = run(lambda axes, plant: RobotBody(arm, plant, axes))
    alone = run(lambda axes, plant: Motors())
    for one, other in zip(together, alone, strict=True):
        assert one.response["angle"] == pytest.approx(other.response["angle"], abs=1e-7)
        assert one.response["torque"] == pytest.approx(other.response["torque"], abs=1e-5)
        assert one.contacts == other.contacts
    assert together[0].contacts
    # To -0.05 deg and so on: each has its own command.
    ends = [one.response["angle"][-1] for one in together]
    assert ends[0] > 1.5 * ends[1] > 0 > ends[2]


def test_what_one_axis_does_moves_the_others_by_the_inertia_of_the_links(robot):
    """Of the first sample: ``(J I + M) q'' = torques``, with one drive that pulls."""
    plant, axes = axes_of(text(), 3)
    body = RobotBody(Arm(robot, robot.home), plant, axes)
    J, Km, tau, width = 1.213, 4.8417e-4, 0.0351, 1e-4
    body.move(axes, [100.0, 0.0, 0.0], width)
    inertia = J * np.eye(3) + mass_matrix(robot, robot.home)
    wanted = np.linalg.solve(inertia, [J * Km / tau * 100, 0, 0]) * width
    found = [axis.omega for axis in axes]
    assert found == pytest.approx(wanted, rel=3e-3)
    assert abs(found[1]) > 0.03 * found[0]


def test_gravity_that_is_held_at_rest_acts_elsewhere(robot):
    """By the difference of its torques; in the pose of rest nothing moves."""
    plant, axes = axes_of(text(RUN.replace("0.05 deg", "80 deg")), 3)
    held = Arm(robot, robot.home, holds=True)
    body = RobotBody(held, plant, axes)
    body.move(axes, [0.0, 0.0, 0.0], 0.01)
    assert max(abs(axis.omega) for axis in axes) < 1e-12
    other = robot.home + np.array([0.1, 0.05, 0.02])
    body.state = replace(body.state, position=Arm(robot, other).joints[None, :])
    body.move(axes, [0.0, 0.0, 0.0], 1e-4)
    lack = gravity_torque(robot, robot.home) - gravity_torque(robot, other)
    inertia = 1.213 * np.eye(3) + mass_matrix(robot, other)
    found = [axis.omega for axis in axes]
    assert found == pytest.approx(np.linalg.solve(inertia, lack) * 1e-4, rel=3e-3)


@pytest.mark.slow
def test_a_pose_out_of_reach_is_an_error_and_a_way_there_ends_the_run(robot):
    with pytest.raises(PoseError):
        run(lambda axes, plant: RobotBody(Arm(robot, np.array([0, 0, 0.6])), plant, axes))
    far = "command: {constant: -8 deg/s}, duration: 3 s, control: {fixed: withdrawal}"
    low = np.array([0.0, 0.0, 0.32])
    runs = run(lambda axes, plant: RobotBody(Arm(robot, low), plant, axes), far)
    assert {one.stopped for one in runs} == {runs[0].stopped}
    assert "leaves what it can reach" in runs[0].stopped
    assert 1 < len(runs[0].response) < 1500


def test_a_loop_that_runs_away_is_told(robot):
    plant, axes = axes_of(text(), 3)
    body = RobotBody(Arm(robot, robot.home), plant, axes)
    with pytest.raises(DesignError, match="beyond all bounds"):
        body.move(axes, [1e12, 0.0, 0.0], 0.002)
