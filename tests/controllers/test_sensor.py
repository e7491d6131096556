"""The force sensor: bounds on what lasts of its errors, and the lags of its filter."""

from fractions import Fraction

import numpy as np
import pytest

from nrs_design.controllers.float32 import is_float32
from nrs_design.controllers.sensor import LowPass, Sensor, build_sensor
from nrs_design.errors import DesignError
from nrs_design.spec.sensor import SensorSpec

F = Fraction


def sensor(**fields):
    return build_sensor(SensorSpec.model_validate(fields))


def test_without_a_sensor_the_force_is_exact():
    assert build_sensor(None) == Sensor()
    assert build_sensor(None).lasting == 0


def test_errors_add_up():
    found = sensor(bias="5e-3 N*m", resolution="2e-3 N*m")
    assert found.errors == {"bias": F("0.005"), "half a step of resolution": F("0.001")}
    assert found.lasting == F("0.006")


def test_a_filter_that_single_precision_loses_is_refused():
    with pytest.raises(DesignError, match="a step keeps all it holds"):
        LowPass(1, F(1, 10**6)).discretize(F(1, 500))


@pytest.mark.parametrize("order", [1, 2, 4])
def test_lags_and_how_a_processor_holds_them(order):
    """``1/(1 + s/w)^order``; sampled, ``p = exp(-w T)`` and one in the long run."""
    low_pass = LowPass(order, F(200))
    for omega in (1.0, 150.0, 3000.0):
        wanted = (1 + 1j * omega / 200) ** order
        assert np.polyval(low_pass.denominator, 1j * omega) == pytest.approx(wanted)
    step = low_pass.discretize(F(1, 500))
    assert is_float32(step.p)
    assert is_float32(step.q)
    assert float(step.p) == pytest.approx(np.exp(-0.4), rel=1e-7)
    assert float(step.p + step.q) == pytest.approx(1, abs=1e-7)
