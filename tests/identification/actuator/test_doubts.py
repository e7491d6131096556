"""What speaks against a motor is said, with its evidence."""

from dataclasses import replace

import numpy as np
import pytest

from nrs_design.identification.actuator.identify import identify_actuator
from tests.identification import motors


def doubts(*records):
    return "; ".join(identify_actuator(records).doubts)


@pytest.mark.parametrize("options", [{"limit": 1800.0}, {"play": 0.03}, {"second": 0.02}], ids=str)
def test_what_the_model_misses(options):
    assert "in errors that are not noise" in doubts(motors.record("multisine", 1, **options))


def test_a_clock_that_is_ahead():
    record = motors.record("chirp", 1, delay=0.0)
    early = replace(record, command=np.roll(record.command, 4))
    text = doubts(early)
    assert "before its command" in text
    assert "clocks" in text
    assert "or command and output are swapped" in text
    late = identify_actuator([early]).fit.dead_time
    assert (late.value, late.low, late.high) == (0.0, 0.0, 0.0)


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
