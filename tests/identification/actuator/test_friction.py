"""Which way friction acts, against a simulation in fine steps."""

import numpy as np
import pytest

from nrs_design.identification.actuator.friction import friction_shape
from nrs_design.identification.held import Held
from tests.identification.synthetic import FRICTION, GAIN, TIME_CONSTANT


def held(command, step=2e-3):
    """The last command acts for a step, too, so that there is an interval for each."""
    time = step * np.arange(len(command) + 1)
    return Held.of(time, np.array([*command, command[-1]], float), 0.0)


def shape(command):
    return friction_shape(held(command), GAIN, TIME_CONSTANT, FRICTION)


def test_a_command_below_the_friction_is_just_balanced():
    command = [0.0, 100.0, -200.0, 50.0]
    # Nothing is known about the time after the last sample.
    assert shape(command)[:-1] == pytest.approx(np.array(command[:-1]) / FRICTION)


def test_after_the_command_ends_the_motor_coasts_and_sticks():
    found = shape([3000.0] * 20 + [0.0] * 60)
    assert (found[:20] == 1.0).all()
    assert found[20] == 1.0
    assert found[-2] == 0.0
    # It stops within one step, in which the friction acts for a part of the time.
    (part,) = found[(found > 0.0) & (found < 1.0)]
    # v = -c + (v0 + c) exp(-t/tau) with c = gain friction reaches zero at tau log(1 + v0/c).
    v0 = GAIN * (3000.0 - FRICTION) * (1 - np.exp(-20 * 2e-3 / TIME_CONSTANT))
    stop = TIME_CONSTANT * np.log(1 + v0 / (GAIN * FRICTION)) / 2e-3
    assert (found[20:] == 1.0).sum() == int(stop)
    assert part == pytest.approx(stop % 1)
