"""The robot on traced values: what is recorded at given angles are the torques of the model."""

from fractions import Fraction

import numpy as np
import pytest

from nrs_design.controllers.operations import StepLaw, Value
from nrs_design.controllers.trace import Trace
from nrs_design.robot.controllers.step_laws import Joints
from nrs_design.robot.controllers.traced_robot import LARGEST_ANGLES, RESTING, TracedRobot
from nrs_design.robot.models import gravity_torque, inverse_dynamics, inverse_kinematics
from tests.robot.controllers.test_step_laws import RNG, THESIS, outputs, poses, run
from tests.robot.models.crooked import crooked

LIMIT = Fraction(1000)


def values(name, unit):
    return tuple(Value(f"{name}_{i}", "", unit, LIMIT, "of a joint") for i in (1, 2, 3))


def recorded(robot, *, moving):
    """Record the joint torques, at rest or of a motion, and make a law of them."""
    trace = Trace()
    traced = TracedRobot.at(robot, trace.values("angle"))
    motion = (trace.values("velocity"), trace.values("acceleration")) if moving else ()
    torques = traced.torques(robot.gravity_vector, *motion)
    names = {f"torque_{i}": torque.positive() for i, torque in enumerate(torques, 1)}
    kept = trace.used(names.values())
    used = {operation.left for operation in kept}
    constants = tuple(c for c in trace.constants.values() if c.name in used)
    given = values("angle", "rad")
    given += (*values("velocity", "rad/s"), *values("acceleration", "rad/s^2")) if moving else ()
    return StepLaw((), given, (), constants, tuple(kept), names, {}, dict.fromkeys(names, "N*m"))


@pytest.mark.parametrize("robot", [THESIS, crooked(THESIS)], ids=["thesis", "crooked"])
def test_torques_are_those_of_the_model(robot):
    """Of all links, at rest and in motion; the model is checked against Pinocchio elsewhere."""
    pose = poses(robot)
    joints = inverse_kinematics(robot, pose)
    velocity, acceleration = RNG.normal(0, 1, joints.shape), RNG.normal(0, 5, joints.shape)
    at_rest = run(recorded(robot, moving=False), angle=joints)
    moved = run(
        recorded(robot, moving=True), angle=joints, velocity=velocity, acceleration=acceleration
    )
    weight = gravity_torque(robot, pose)
    wanted = inverse_dynamics(robot, pose, velocity, acceleration)
    assert at_rest.valid.all()
    assert np.abs(wanted - weight).max() > 1
    np.testing.assert_allclose(outputs(at_rest), weight, atol=2e-5, rtol=2e-6)
    np.testing.assert_allclose(outputs(moved), wanted, atol=2e-5, rtol=2e-6)


def test_the_angles_are_those_of_the_polynomials():
    """Planes to 1.5 rad, the crank to 2 rad: the header says so."""
    assert (Fraction(3, 2), Fraction(3, 2), 2) == LARGEST_ANGLES
    assert Joints(THESIS, 1.0).angles[0].limit <= LARGEST_ANGLES[0]
    assert RESTING == (0, 0, 0)
