import numpy as np
import pytest

from nrs_design.robot.models.kinematics import JointMotion, inverse_kinematics
from nrs_design.robot.motion_control import LawState, design_computed_torque

POSE = np.array([[0.05, -0.1, 0.2]])
ACCELERATION = np.array([[0.3, -0.1, 0.2]])
VELOCITY = np.array([[0.2, 0.1, -0.3]])


@pytest.fixture(scope="module")
def law(spec, load):
    return design_computed_torque(spec, load)


@pytest.fixture(scope="module")
def angle(tilted):
    return 5 * inverse_kinematics(tilted, POSE)


def test_equation_4_18_with_acceleration_and_error_of_the_encoders(law, load, angle):
    error = np.array([[0.01, -0.02, 0.005]])
    reference = JointMotion((angle + error) / 5, VELOCITY, ACCELERATION)
    memory = LawState(error - 0.001)
    command, _ = law.step(memory, reference, angle)
    wanted = 5 * ACCELERATION + 56.9801 * 0.001 / 0.002 + 1623.85 * error
    terms = load.terms(angle)
    expected = 2.7044e5 * (terms.inertia[0] @ wanted[0] / (905 * 5) + terms.gravity[0] / 905)
    assert command[0] == pytest.approx(expected, rel=1e-5)
