"""What a misfit looks like is named, with its evidence."""

from dataclasses import replace

import numpy as np
import pytest

from nrs_design.identification.actuator.identify import identify_actuator
from tests.identification import motors
from tests.identification.support import MOTOR


def doubts(*records):
    return "; ".join(identify_actuator(records, MOTOR).doubts)


@pytest.mark.parametrize("kind", [pytest.param("chirp", marks=pytest.mark.slow), "multisine"])
def test_saturation(kind):
    text = doubts(motors.record(kind, 1, limit=1800.0))
    assert "the model misses" in text
    assert "likely saturation: commands act as if cut" in text


@pytest.mark.slow
def test_backlash():
    text = doubts(motors.record("multisine", 1, play=0.03))
    assert "likely backlash: the output loses some 0.02" in text


def test_an_offset_of_the_command():
    record = motors.record("PRBS", 1)
    text = doubts(replace(record, command=record.command - 150.0))
    assert "an offset of some 18" in text
    # Of a command with two levels, a limit does the same.
    assert "likely saturation" in text


def test_a_clock_that_is_ahead():
    record = motors.record("chirp", 1, delay=0.0)
    early = replace(record, command=np.roll(record.command, 4))
    text = doubts(early)
    assert "before its command" in text
    assert "clocks" in text
    assert "or command and output are swapped" in text
    late = identify_actuator([early], MOTOR).chosen.dead_time
    assert (late.value, late.low, late.high) == (0.0, 0.0, 0.0)


@pytest.mark.slow
def test_a_second_lag_needs_a_second_order():
    result = identify_actuator([motors.record("PRBS", 1, second=0.02)], MOTOR)
    fit = result.chosen
    assert fit.order == 2
    assert "first order fails" in result.reason
    assert fit.time_constant.value == pytest.approx(motors.TIME_CONSTANT + 0.02, rel=0.05)
    # (tau1 + tau2)/(2 sqrt(tau1 tau2))
    damping = (0.0351 + 0.02) / (2 * np.sqrt(0.0351 * 0.02))
    assert fit.motor.damping == pytest.approx(damping, rel=0.05)


def test_noise_is_no_doubt():
    assert doubts(motors.record("chirp", 4)) == ""


@pytest.mark.slow
def test_what_is_not_determined_is_said():
    """A slow ramp shows the sum of time constant and dead time, and not which is which."""
    record = motors.record("chirp", 1)
    slow = 2000 * record.time / record.time[-1] + 1000
    angle, _, _ = motors.simulate(slow)
    noise = 3e-3 * np.random.default_rng(0).normal(size=len(angle))
    text = doubts(replace(record, command=slow, output=angle + noise))
    assert "do not determine" in text


@pytest.mark.parametrize(("factor", "doubted"), [(1e-3, True), (1.0, False), (1e3, True)])
def test_another_unit_of_time_is_suspected(factor, doubted):
    """Seconds that are read as milliseconds give a motor a thousand times too fast."""
    record = motors.record("PRBS", 1)
    short = replace(
        record,
        time=factor * record.time[:500],
        command=record.command[:500],
        output=record.output[:500],
    )
    assert ("is that their unit?" in doubts(short)) == doubted
