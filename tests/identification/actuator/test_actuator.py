"""The motor of thesis 4.1 from synthetic experiments."""

from dataclasses import replace

import numpy as np
import pytest

from nrs_design.identification.actuator.identify import identify_actuator
from nrs_design.identification.datasets.records import read_actuator
from nrs_design.identification.errors import DataError
from tests.identification import motors
from tests.identification.support import sinusoids, write_csv

FEW = (1.2, 2.0, 3.0, 5.0, 8.0, 14.0)


@pytest.fixture(scope="module")
def found():
    return identify_actuator(sinusoids(3, FEW))


def test_parameters_of_the_thesis(found):
    fit = found.fit
    assert fit.dead_time.low == 0.0
    for estimate, value, rel in (
        (fit.gain, 4.8417e-4, 5e-3),
        (fit.time_constant, 0.0351, 5e-3),
        (fit.friction, 276.575, 0.03),
    ):
        assert estimate.covers(value)
        assert estimate.value == pytest.approx(value, rel=rel)


def test_a_failed_start_is_no_end():
    fit = identify_actuator(sinusoids(1, (2.0, 9.0))).fit
    assert fit.time_constant.covers(0.0351)
    assert fit.friction.covers(276.575)


RECORDS = sinusoids(0, (2.0, 4.0, 9.0))
NOISE = np.random.default_rng(1).normal(size=len(RECORDS[0].time))


@pytest.mark.parametrize(
    ("data", "message"),
    [
        ([], "no records"),
        ([*RECORDS, RECORDS[0]], "there twice"),
        ([replace(r, output=-r.output) for r in RECORDS], "moves against the command"),
        ([replace(RECORDS[0], output=NOISE)], "does not follow"),
        ([RECORDS[0], replace(RECORDS[1], unit="V")], "in V and rpm"),
    ],
)
def test_bad_input(data, message):
    with pytest.raises(DataError, match=message):
        identify_actuator(data)


def test_a_pause_cuts_a_record(tmp_path):
    """What is left begins in motion."""
    whole = motors.record("PRBS", 1)
    kept = np.r_[0:300, 400 : len(whole.time)]
    columns = (values[kept] for values in (whole.time, whole.command, whole.output))
    record = read_actuator(write_csv(tmp_path / "a.csv", "time_s,command_rpm,angle_rad", *columns))
    found = identify_actuator([record])
    assert len(record.time) == len(whole.time) - 400
    assert found.fit.ranges[0].covers(motors.GAIN)
    assert found.fit.ranges[1].covers(motors.TIME_CONSTANT)
    assert found.remarks[0].startswith("a: 1 pause in the record: its longest stretch is used")
    assert found.doubts == ()


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
