"""Any command, with dead time, friction and either output."""

from dataclasses import replace

import numpy as np
import pytest

from nrs_design.identification.actuator.fit import fit_in_time, scan_motor
from nrs_design.identification.actuator.identify import identify_actuator
from nrs_design.identification.actuator.motor import MotorModel
from nrs_design.identification.datasets.records import SignalRecord
from nrs_design.identification.errors import DataError
from tests.identification import motors, synthetic
from tests.identification.support import sinusoids, source

KINDS = ("stair", "chirp", "PRBS", "multisine", "closed loop")
TRUE = MotorModel(motors.GAIN, motors.TIME_CONSTANT, motors.FRICTION, motors.DELAY)


def found(record):
    return identify_actuator([record])


@pytest.mark.parametrize("is_angle", [True, False])
@pytest.mark.parametrize("kind", KINDS)
def test_the_simulation_is_that_of_fine_steps(kind, is_angle):
    record = motors.record(kind, 3, noise=0.0, is_angle=is_angle)
    error = record.output - TRUE.simulate(record)
    assert np.abs(error).max() < (1e-5 if is_angle else 2e-3)


@pytest.mark.parametrize(
    ("kind", "is_angle"),
    [*((kind, True) for kind in KINDS), ("multisine", False)]
    + [pytest.param(kind, False, marks=pytest.mark.slow) for kind in KINDS if kind != "multisine"],
)
def test_parameters(kind, is_angle):
    """Near, at least; that intervals hold them in 95 % of cases is counted elsewhere."""
    result = found(motors.record(kind, 1, is_angle=is_angle))
    fit = result.fit
    assert fit.gain.value == pytest.approx(motors.GAIN, rel=0.01)
    assert fit.time_constant.value == pytest.approx(motors.TIME_CONSTANT, rel=0.02)
    assert fit.friction.value == pytest.approx(motors.FRICTION, rel=0.05)
    assert fit.dead_time.value == pytest.approx(motors.DELAY, abs=4e-4)
    assert fit.dead_time.low > 0.006
    assert result.doubts == ()
    assert result.step == pytest.approx(0.002)


def test_a_dead_time_that_is_not_determined_is_said():
    result = found(motors.record("multisine", 1))
    assert "leaves out" in result.caveats[-1]
    unknown = replace(result, fit=replace(result.fit, dead_time=None))
    assert "not determine the dead time" in unknown.caveats[-1]


def test_under_one_step_friction_is_not_told_from_gain():
    result = found(motors.record("step", 1))
    assert result.fit.friction is None
    assert result.fit.dead_time.covers(motors.DELAY)
    assert "one level only" in result.doubts[0]


@pytest.mark.parametrize("is_angle", [True, False])
def test_one_step_against_the_command_is_refused(is_angle):
    """Friction above the command would explain it as well, and no motor turns by friction."""
    record = motors.record("step", 1, is_angle=is_angle)
    with pytest.raises(DataError, match="their signs are opposite"):
        scan_motor([replace(record, output=-record.output)])


def test_a_motor_without_friction_or_dead_time():
    fit = found(motors.record("chirp", 2, friction=0.0, delay=0.0)).fit
    assert fit.friction is None
    assert fit.dead_time.low == 0.0
    assert fit.dead_time.high < 2e-4


@pytest.mark.slow
@pytest.mark.parametrize("is_angle", [True, pytest.param(False, marks=pytest.mark.slow)])
def test_a_square_wave_without_friction(is_angle):
    # A coarse scan sees friction here: with it, the search ended far from the least errors.
    time = np.arange(5000) / motors.RATE
    command = np.where(time % 2 < 1, 1000.0, -1000.0)
    command[0] = 0.0
    record = SignalRecord(source("square"), time, command, time, is_angle)
    true = replace(TRUE, time_constant=0.05, friction=None, delay=0.01)
    output = true.forced(record, *true.hold(record))
    noise = 5e-4 * np.ptp(output) * np.random.default_rng(1).normal(size=len(output))
    result = found(replace(record, output=output + noise))
    assert result.fit.friction is None
    assert result.fit.time_constant.value == pytest.approx(0.05, rel=3e-3)
    assert result.fit.dead_time.value == pytest.approx(0.01, abs=1e-4)
    assert result.doubts == ()


def test_other_units_of_the_command():
    """A volt is a thousandth of the command here, so that the gain is a thousand times larger."""
    record = motors.record("PRBS", 1)
    result = found(replace(record, command=record.command / 1000, unit="V"))
    assert result.fit.gain.value == pytest.approx(1000 * motors.GAIN, rel=0.01)
    assert result.fit.friction.value == pytest.approx(motors.FRICTION / 1000, rel=0.05)
    assert result.unit == "V"


def test_a_start_with_too_little_friction():
    """A step that is cut for one parameter only leaves the valley, and the search ended there."""
    records = sinusoids(1, (2, 6, 14))
    fit = fit_in_time(records, MotorModel(4.27e-4, 0.0292, 25.0, 0.002))
    assert fit.motor.friction == pytest.approx(synthetic.FRICTION, rel=0.02)
    assert fit.tells_friction
    assert not fit_in_time(records, replace(fit.motor, friction=None)).tells_friction
