"""Held commands and linear models of them, against a simulation in fine steps."""

import numpy as np
import pytest
from scipy.signal import cont2discrete, lfilter

from nrs_design.identification.zero_order_hold import HeldCommand, Lags

TIME = np.cumsum(np.random.default_rng(0).uniform(0.001, 0.004, 300)) - 0.001
COMMAND = np.repeat(np.random.default_rng(1).normal(size=20), 15)
FINE = np.linspace(TIME[0], TIME[-1], 200_001)


def late(delay):
    index = np.searchsorted(TIME + delay, FINE, side="right") - 1
    return COMMAND[np.maximum(index, 0)]


@pytest.mark.parametrize("delay", [0.0, 0.0031, 0.02])
@pytest.mark.parametrize(
    ("lags", "system"),
    [
        (Lags.first_order(0.03), ([1], [0.03, 1])),
        (Lags.second_order(1 / 40, 0.3), ([1600], [1, 24, 1600])),
        (Lags.second_order(1 / 40, 1.7), ([1600], [1, 136, 1600])),
        (Lags.second_order(1 / 40, 1.0), ([1600], [1, 80, 1600])),
    ],
)
def test_against_fine_steps(lags, system, delay):
    held = HeldCommand.build(TIME, COMMAND, delay)
    (numerator,), denominator, _ = cont2discrete(system, FINE[1] - FINE[0])
    output = lfilter(numerator, denominator, late(delay))
    wanted = np.interp(TIME, FINE, output)
    assert lags.velocity(held, held.command)[held.samples] == pytest.approx(wanted, abs=3e-3)
    angle = np.concatenate([[0], np.cumsum((output[1:] + output[:-1]) / 2 * np.diff(FINE))])
    found = lags.angle(held, held.command)[held.samples]
    assert found == pytest.approx(np.interp(TIME, FINE, angle), abs=1e-4)


@pytest.mark.parametrize("damping", [0.4, 2.0])
def test_free_motion_has_two_states(damping):
    lags = Lags.second_order(1 / 30, damping)
    assert lags.free(TIME, angle=False).shape == (300, 2)
    assert lags.free(TIME, angle=True).shape == (300, 3)
