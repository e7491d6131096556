"""Functions of angles in single precision, against those of NumPy in double precision."""

from fractions import Fraction

import numpy as np
import pytest

from nrs_design.controllers.operations import StepLaw, Value
from nrs_design.controllers.replica import step
from nrs_design.controllers.trace import Trace
from nrs_design.robot.controllers.traced_trigonometry import (
    LARGEST_ANGLE,
    LARGEST_PLANE_ANGLE,
    sine_and_cosine,
    tangent,
)


def computed(function, angles):
    """Return what a traced function has at encoder angles, in double precision."""
    trace = Trace()
    results = {f"y{i}": one.positive() for i, one in enumerate(function(trace.value("x")))}
    kept = trace.used(results.values())
    used = {operation.left for operation in kept}
    constants = tuple(c for c in trace.constants.values() if c.name in used)
    given = (Value("x", "x", "rad", Fraction(100), "an angle"),)
    law = StepLaw((), given, (), constants, tuple(kept), results, {}, dict.fromkeys(results, "1"))
    found = step(law, np.zeros(len(angles), np.uint32), {"x": angles}).outputs
    return [values.astype(float) for values in found.values()]


@pytest.mark.parametrize("ratio", [1.0, 5.0])
def test_sine_and_cosine_with_factor_and_offset(ratio):
    angles = np.linspace(-ratio * LARGEST_ANGLE, ratio * LARGEST_ANGLE, 20001, dtype=np.float32)
    sine, cosine = computed(lambda x: sine_and_cosine(x, ratio, 0.5, 0.25), angles)
    joints = angles.astype(float) / ratio
    np.testing.assert_allclose(sine, 0.5 * np.sin(joints), atol=1.5e-7)
    np.testing.assert_allclose(cosine, 0.5 * np.cos(joints) + 0.25, atol=1.5e-7)


@pytest.mark.parametrize("ratio", [1.0, 5.0])
def test_the_angle_of_the_tangent(ratio):
    most = ratio * LARGEST_PLANE_ANGLE
    angles = np.linspace(-most, most, 20001, dtype=np.float32)
    (found,) = computed(lambda x: (tangent(x, ratio),), angles)
    np.testing.assert_allclose(np.arctan(found), angles.astype(float) / ratio, atol=1.6e-7)
