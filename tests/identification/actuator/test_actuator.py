"""The motor of thesis 4.1 from synthetic experiments."""

from dataclasses import replace

import numpy as np
import pytest

from nrs_design.errors import DataError
from nrs_design.identification.actuator.identify import identify_actuator
from nrs_design.identification.datasets.records import FrequencyResponse, read_actuator
from tests.identification import motors
from tests.identification.support import sinusoids, source, write_csv

FEW = (1.2, 2.0, 3.0, 5.0, 8.0, 14.0)


@pytest.fixture(scope="module")
def found():
    return identify_actuator(sinusoids(3, FEW))


def response(scatter=0.0, seed=0):
    w = 2 * np.pi * np.geomspace(0.1, 30, 15)
    noise = np.random.default_rng(seed).normal(size=(2, 15))
    G = 4.8417e-4 / (1 + 1j * w * 0.0351) * np.exp(scatter * (noise[0] + 1j * noise[1]))
    return FrequencyResponse(source("response"), w, G)


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


def test_ready_response():
    fit = identify_actuator([response(0.01, 5)]).fit
    assert fit.gain.covers(4.8417e-4)
    assert fit.time_constant.covers(0.0351)
    assert fit.friction is None
    exact = identify_actuator([response()]).fit
    assert exact.gain.value == pytest.approx(4.8417e-4, rel=1e-9)
    assert exact.time_constant.value == pytest.approx(0.0351, rel=1e-9)


def test_a_failed_start_is_no_end():
    fit = identify_actuator(sinusoids(1, (2.0, 9.0))).fit
    assert fit.time_constant.covers(0.0351)
    assert fit.friction.covers(276.575)


RECORDS = sinusoids(0, (2.0, 4.0, 9.0))
NOISE = np.random.default_rng(1).normal(size=len(RECORDS[0].time))


@pytest.mark.parametrize(
    ("data", "message"),
    [
        ([], "0 records"),
        ([*RECORDS, response()], "3 records and 1"),
        ([*RECORDS, RECORDS[0]], "there twice"),
        ([replace(r, output=-r.output) for r in RECORDS], "moves against the command"),
        ([replace(RECORDS[0], output=NOISE)], "does not follow"),
        ([RECORDS[0], replace(RECORDS[1], unit="V")], "in V and rpm"),
    ],
)
def test_bad_input(data, message):
    with pytest.raises(DataError, match=message):
        identify_actuator(data)


@pytest.fixture(scope="module")
def runs():
    """Three short runs of a motor whose gain differs by 5 % from one to the next."""
    return [
        replace(
            made, time=made.time[:400], command=made.command[:400], output=f * made.output[:400]
        )
        for made, f in ((motors.record("PRBS", i), 0.9 + 0.05 * i) for i in (1, 2, 3))
    ]


@pytest.mark.parametrize(
    "coverage", ["prediction", pytest.param("tolerance", marks=pytest.mark.slow)]
)
def test_a_range_for_other_records_is_wider_than_their_spread(runs, coverage):
    """With two degrees of freedom, Student's t at 97.5 % on both sides is 6.205."""
    found = identify_actuator(runs, coverage)
    gain = found.ranges[0]
    half = {"prediction": 6.205 * np.sqrt(4 / 3), "tolerance": 20.0}[coverage]
    spread = np.std(np.log([0.95, 1.0, 1.05]), ddof=1)
    assert np.log(gain.high / gain.value) > 0.9 * half * spread
    assert (found.coverage, found.fit.gain.high < gain.high) == (coverage, True)


@pytest.mark.parametrize(
    ("data", "said"),
    [
        ("one", "needs several records, and there is one"),
        ("response", "needs several records, and there is one"),
        ("at rest", "PRBS-4 alone does not determine the motor"),
    ],
)
def test_no_range_for_other_records(runs, data, said):
    still = replace(motors.record("PRBS", 4), output=np.zeros(2000))
    given = {"one": runs[:1], "response": [response()], "at rest": [runs[0], still]}[data]
    with pytest.raises(DataError, match=said):
        identify_actuator(given, "prediction")


def test_pauses_part_a_record_whose_stretches_are_fitted_together(tmp_path):
    whole = motors.record("PRBS", 1)
    kept = np.r_[0:800, 900:1000, 1010:1040, 1100 : len(whole.time)]
    columns = (values[kept] for values in (whole.time, whole.command, whole.output))
    path = write_csv(tmp_path / "paused.csv", "time_s,command_rpm,angle_rad", *columns)
    records = read_actuator(path)
    assert [(r.name, len(r.time)) for r in records] == [
        ("paused", 800), ("paused, part 2", 100), ("paused, part 3", len(whole.time) - 1100),
    ]  # fmt: skip
    found = identify_actuator(records)
    assert found.ranges[0].covers(motors.GAIN)
    assert found.ranges[1].covers(motors.TIME_CONSTANT)
    assert found.remarks[0].startswith("paused: 3 pauses part the record: its stretches are fitted")
    assert found.doubts == ()
    with pytest.raises(DataError, match="needs several records"):
        identify_actuator(records, "prediction")


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
