"""An engine that others wrote, beside ours: the same law on other mechanics."""

from itertools import pairwise

import numpy as np
import pytest

from nrs_design.progress import silent
from nrs_design.robot.simulation.mujoco_body import STEP, MujocoBody
from nrs_design.robot.simulation.robot_body import Arm, RobotBody
from nrs_design.simulation.bodies import deviation
from nrs_design.simulation.processor import Motors, run_axes
from tests.robot.models.crooked import crooked
from tests.simulation.interactions import axes_of, text_of

pytest.importorskip("mujoco", reason="MuJoCo is not installed")

# Into tissue and out, without a controller's choice: no difference can flip a switch.
RUN = (
    "command: {sinusoid: {amplitude: 7 deg/s, frequency: 1 Hz}}, duration: 0.8 s, "
    "surfaces: [{environment: soft, at: 0.5 deg}], control: {fixed: withdrawal}%s"
)
POWER = (
    "{model: hunt-crossley, stiffness: 43 N*m/rad, damping: 0.1 N*m*s/rad, exponent: 1.2, "
    "about: 0.01 rad, preload: [0.005 rad, 0.02 rad]}"
)
HOMES = [False, True]


def loaded(errors="", law=None):
    """A loop whose motor carries the tissue."""
    environments = None if law is None else {"soft": law}
    more = "contact: kept\n" if law else ""
    text = text_of(environments=environments, scenario=RUN % errors, more=more)
    return text.replace("0.0351 s}", "0.0351 s, load_inertia: 1.213 kg*m^2}")


def run(text, body, count=1):
    plant, axes = axes_of(text, count)
    return run_axes(axes, body(axes, plant), "any", 10**6, silent)


def fastest(runs):
    """The largest change of a velocity over a sample, as an acceleration in rad/s^2."""
    return max(np.abs(np.diff(one.response["velocity"])).max() for one in runs) / 0.002


def largest(runs, others):
    each = [deviation(*pair) for pair in zip(runs, others, strict=True)]
    return tuple(max(getattr(d, name) for d in each) for name in ("angle", "velocity", "torque"))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("errors", "law"),
    [
        ("", None),
        pytest.param(", errors: {friction: 120 rpm}", None, marks=pytest.mark.slow),
        pytest.param("", POWER, marks=pytest.mark.slow),
    ],
    ids=["smooth", "friction", "hunt-crossley"],
)
def test_a_hinge_moves_as_the_motor_does(errors, law):
    """A step of MuJoCo takes the push of its start and the damping of its end: first order.

    So velocities are apart by about a step of the largest acceleration, and angles by much less, as
    the loop brings them back; halving the step halves both.
    """
    text = loaded(errors, law)
    ours = run(text, lambda axes, plant: Motors())
    steepest = fastest(ours)
    apart = [
        largest(ours, run(text, lambda axes, plant, h=h: MujocoBody(axes, plant, step=h)))
        for h in (2 * STEP, STEP, STEP / 2)
    ]
    angle, velocity, torque = apart[1]
    assert velocity < STEP * steepest
    assert angle < 0.1 * STEP * steepest
    assert 0 < torque < (43 if law is None else 80) * angle * 1.1
    for coarse, fine in pairwise(apart):
        # What is left is the error of our own eight parts of a sample.
        assert np.array(fine[:2]) == pytest.approx(np.array(coarse[:2]) / 2, rel=0.35)
    assert ours[0].response["torque"].max() > 0.1


def test_without_a_load_the_tissue_does_not_push_the_hinge():
    text = text_of(scenario=RUN % "")
    ours = run(text, lambda axes, plant: Motors())
    theirs = run(text, lambda axes, plant: MujocoBody(axes, plant))
    angle, velocity, _ = largest(ours, theirs)
    steepest = fastest(ours)
    assert angle < 0.1 * STEP * steepest
    assert velocity < STEP * steepest


@pytest.mark.slow
@pytest.mark.parametrize("holds", HOMES, ids=["everywhere", "at-rest"])
def test_the_robot_moves_as_ours(robot, holds):
    """Closed loops, masses and gravity are MuJoCo's; ours has closed forms and virtual work."""
    robot = crooked(robot).tilted(0.3)
    arm = Arm(robot, robot.home + np.array([0.05, -0.08, 0.01]), holds)
    text = loaded(", errors: {friction: 30 rpm}")
    ours = run(text, lambda axes, plant: RobotBody(arm, plant, axes), 3)
    apart = [
        largest(ours, run(text, lambda axes, plant, h=h: MujocoBody(axes, plant, arm, h), 3))
        for h in (4 * STEP, 2 * STEP)
    ]
    steepest = fastest(ours)
    for h, (angle, velocity, _) in zip((4 * STEP, 2 * STEP), apart, strict=True):
        # Twice, as one axis pushes the others.
        assert velocity < 2 * h * steepest
        assert angle < 0.1 * h * steepest
    assert np.array(apart[1][:2]) == pytest.approx(np.array(apart[0][:2]) / 2, rel=0.1)
    alone = run(text, lambda axes, plant: Motors(), 3)
    # Links and gravity matter much more than what the engines differ by.
    assert largest(ours, alone)[0] > 20 * apart[1][0]
