"""The direction of the endoscope from encoders, against that of the pose."""

from fractions import Fraction

import numpy as np
import pytest

from nrs_design.controllers.operations import StepLaw, Value
from nrs_design.controllers.trace import Trace
from nrs_design.robot.controllers.traced_endoscope import Axes, Endoscope
from nrs_design.robot.models import inverse_kinematics
from nrs_design.robot.models.geometry import direction
from tests.robot.controllers.test_step_laws import RATIO, THESIS, exchanged, outputs, poses, run
from tests.robot.controllers.test_traced_weight import turned

ROBOTS = pytest.mark.parametrize(
    "robot", [THESIS, exchanged(THESIS), turned(THESIS, 0.4)], ids=["thesis", "exchanged", "turned"]
)


@ROBOTS
def test_it_points_where_the_pose_says(robot):
    trace = Trace()
    scope = Endoscope.at(robot, trace.values("angle"), RATIO)
    made = {
        "along": scope.cos_gamma,
        "across": scope.b[0] * scope.sin_gamma,
        "up": scope.b[1] * scope.sin_gamma,
    }
    names = {name: value.positive() for name, value in made.items()}
    kept = trace.used(names.values())
    used = {operation.left for operation in kept}
    constants = tuple(c for c in trace.constants.values() if c.name in used)
    given = tuple(Value(f"angle_{i}", "", "rad", Fraction(100), "an encoder") for i in (1, 2, 3))
    law = StepLaw((), given, (), constants, tuple(kept), names, {}, dict.fromkeys(names, "1"))
    pose = poses(robot)
    found = outputs(run(law, angle=RATIO * inverse_kinematics(robot, pose)))
    W, (x, y, _) = direction(pose), robot.legs[2].axis
    wanted = np.stack([x * W[0] + y * W[1], x * W[1] - y * W[0], W[2]], axis=-1)
    np.testing.assert_allclose(found, wanted, atol=5e-7)


@ROBOTS
def test_axes_are_those_of_the_legs(robot):
    axes, (x, y, _) = Axes.of(robot), robot.legs[2].axis
    for seen, leg in zip((axes.first, axes.second), robot.legs, strict=False):
        along, across = (axes.size * number for number in seen)
        np.testing.assert_allclose(
            [along * x - across * y, along * y + across * x], leg.axis[:2], atol=1e-15
        )
    assert axes.up > 0
