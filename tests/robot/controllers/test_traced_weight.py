"""The weight from few operations, against the gravity torques of the model."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from nrs_design.controllers.operations import StepLaw, Value
from nrs_design.controllers.trace import Trace
from nrs_design.robot.controllers.step_laws import Joints
from nrs_design.robot.controllers.traced_weight import weight
from nrs_design.robot.models import gravity_torque, inverse_kinematics
from tests.robot.controllers.test_step_laws import (
    RATIO,
    THESIS,
    base_of,
    exchanged,
    outputs,
    poses,
    run,
)
from tests.robot.models.crooked import crooked

GRAVITY = tuple(
    Value(f"gravity_{axis}", "", "m/s^2", Fraction(1000), "in the base frame") for axis in "xz"
)


def turned(robot, angle):
    """The same robot with all base axes turned about the vertical."""
    legs = tuple(replace(leg, azimuth=leg.azimuth + angle) for leg in robot.legs)
    return replace(robot, legs=legs)


@pytest.mark.parametrize(
    "robot",
    [THESIS, crooked(THESIS), exchanged(THESIS), turned(THESIS, 0.4)],
    ids=["thesis", "crooked", "exchanged", "turned"],
)
def test_the_weight_is_that_of_the_model(robot):
    """Middle arms with mass beside their plane, and axes in any direction, too."""
    joints = Joints(robot, RATIO)
    carried = joints.simplified
    trace = Trace()
    gravity = trace.value("gravity_x"), 0.0, trace.value("gravity_z")
    torques = weight(carried, trace.values("angle"), RATIO, gravity)
    names = {f"torque_{i}": torque.positive() for i, torque in enumerate(torques, 1)}
    kept = trace.used(names.values())
    used = {operation.left for operation in kept}
    constants = tuple(c for c in trace.constants.values() if c.name in used)
    given = (*joints.angles, *GRAVITY)
    law = StepLaw((), given, (), constants, tuple(kept), names, {}, dict.fromkeys(names, "N*m"))
    pose = poses(robot)
    held = base_of(robot, len(pose))
    held.pop("correction")
    result = run(law, angle=RATIO * inverse_kinematics(robot, pose), **held)
    assert result.valid.all()
    wanted = gravity_torque(carried, pose)
    assert len(pose) > 30
    assert np.abs(wanted).max() > 1
    np.testing.assert_allclose(outputs(result), wanted, atol=5e-6, rtol=2e-6)
