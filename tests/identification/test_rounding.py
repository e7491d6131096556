"""Coarse sensors."""

import numpy as np
import pytest

from nrs_design.identification.rounding import resolution, rounding_of_velocity, rounding_scatter

TIME = np.arange(2000) / 100
SMOOTH = 0.005 * (1 - np.cos(TIME))
RAMPS = 0.005 * np.interp(TIME % 4, [0, 0.5, 1.5, 2.5, 3.5, 4], [0, 0, 1, 1, 0, 0])


def test_step_of_the_encoder():
    """Thesis 6.1: 4096 counts per turn on a handle of 100 mm; a file rounds again to its digits."""
    count = 0.1 * 2 * np.pi / 4096
    seen = count * np.round(SMOOTH / count)
    assert resolution(seen) == pytest.approx(count)
    assert resolution(np.round(seen, 6)) == pytest.approx(count, rel=0.01)


def test_a_smooth_signal_has_no_step():
    """A ramp changes by one amount from sample to sample, which is not the step of its sensor."""
    assert resolution(SMOOTH + 1e-5 * np.random.default_rng(0).normal(size=2000)) == 0.0
    for clean in (RAMPS, 3 + RAMPS, np.abs(TIME % 2 - 1), RAMPS.astype(np.float32).astype(float)):
        assert resolution(clean) == 0.0
    # 5e-5 m from sample to sample.
    assert resolution(1e-5 * np.round(RAMPS / 1e-5)) == 0.0
    assert resolution(np.zeros(100)) == 0.0


@pytest.mark.parametrize("step", [3e-4, 1.2e-4, 2.1e-5, 1.3e-5])
def test_the_step_of_the_sensor_under_a_ramp(step):
    assert resolution(step * np.round(RAMPS / step)) == pytest.approx(step)


def test_rounding_dominates_a_slow_velocity():
    coarse = 1e-4 * np.round(SMOOTH / 1e-4)
    true = np.mean(np.gradient(SMOOTH, TIME) ** 2)
    seen = np.mean(np.gradient(coarse, TIME) ** 2)
    assert rounding_of_velocity(TIME, coarse) == pytest.approx(1 - true / seen, abs=0.1)


def test_rests_with_one_reading_are_one_error():
    readings = np.repeat([0.0, 1.0, 2.0, 1.0, 0.0], [20, 2, 2, 2, 20])
    scatter = rounding_scatter(readings, np.ones((46, 1)), 1.0)
    assert 12 * scatter[0, 0] == pytest.approx(2 * 20**2 + 3 * 2**2)
