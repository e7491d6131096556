"""The force sensor: bounds on what lasts of its errors, and the lags of its filter."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from nrs_design.controllers.float32 import is_float32
from nrs_design.controllers.sensor import LowPass, Sensor, build_sensor, length_above
from nrs_design.errors import DesignError
from nrs_design.spec.sensor import SensorSpec

F = Fraction
TOOL = {"mass": "0.797 kg", "center_of_mass": {"x": "0 m", "y": "0 m", "z": "0.2 m"}}


def sensor(**fields):
    return build_sensor(SensorSpec.model_validate(fields))


def test_without_a_sensor_the_force_is_exact():
    assert build_sensor(None) == Sensor()
    assert build_sensor(None).lasting == 0


def test_one_degree_of_an_imu():
    """0.797 kg at 0.2 m: 0.027 N m, which is 1.5 deg/s at Bt = 1.04 and 19 % of 8 deg/s."""
    error = float(sensor(tool=TOOL, imu_error="1 deg").lasting)
    assert error == pytest.approx(0.797 * 9.81 * 0.2 * np.radians(1), rel=1e-12)
    assert f"{error:.3f}" == "0.027"
    creep = np.degrees(error / 1.04)
    assert f"{creep:.1f}" == "1.5"
    assert f"{100 * creep / 8:.0f}" == "19"


def test_errors_add_up():
    found = sensor(
        bias="5e-3 N*m",
        force_bias="0.1 N",
        pivot={"x": "0 m", "y": "0.03 m", "z": "-0.04 m"},
        drift="1e-5 N*m/s",
        tared_every="600 s",
        resolution="2e-3 N*m",
    )
    assert found.errors == {
        "bias": F("0.005"),
        "bias of the force": F("0.005"),
        "drift since taring": F("0.006"),
        "half a step of resolution": F("0.001"),
    }
    assert found.lasting == F("0.017")


@given(st.integers(0, 2**32))
def test_no_pose_is_further_off_than_the_bound(seed):
    """Gravity in any direction, seen in one that is off by both angles, on a tool in its range."""
    rng = np.random.default_rng(seed)
    ranges = {
        "mass": {"nominal": "0.8 kg", "range": ["0.78 kg", "0.81 kg"]},
        "center_of_mass": {
            "x": {"nominal": "0.01 m", "range": ["0 m", "0.012 m"]},
            "y": {"nominal": "-0.005 m", "range": ["-0.006 m", "0.001 m"]},
            "z": {"nominal": "0.2 m", "range": ["0.19 m", "0.21 m"]},
        },
    }
    pivot = {"x": "0 m", "y": "0.02 m", "z": "-0.1 m"}
    found = sensor(tool=ranges, imu_error="1 deg", pose_error="0.5 deg", pivot=pivot)
    p = np.array([0, 0.02, -0.1])
    mass = rng.uniform(0.78, 0.81)
    center = rng.uniform([0, -0.006, 0.19], [0.012, 0.001, 0.21])
    g = 9.81 * Rotation.random(random_state=rng).apply([0, 0, 1])
    seen = g
    for angle in (1, 0.5):
        axis = np.cross(seen, rng.normal(size=3))
        seen = Rotation.from_rotvec(np.radians(angle) * axis / np.linalg.norm(axis)).apply(seen)
    felt = np.cross(center - p, mass * g)
    taken_off = np.cross(np.array([0.01, -0.005, 0.2]) - p, 0.8 * seen)
    assert np.linalg.norm(felt - taken_off) <= float(found.lasting)


@given(st.lists(st.fractions(-10, 10), min_size=3, max_size=3))
def test_lengths_are_enclosed(vector):
    high = length_above(vector)
    square = sum(c * c for c in vector)
    assert max(0, high - F(1, 10**24)) ** 2 <= square <= high**2


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
