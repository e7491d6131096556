"""Merging into a spec: values, comments, refusals."""

from dataclasses import replace
from fractions import Fraction
from functools import cache

import pytest

from nrs_design.errors import SpecError
from nrs_design.identification import write_spec
from nrs_design.identification.actuator.identify import identify_actuator
from nrs_design.identification.delay.identify import identify_delay
from nrs_design.identification.errors import DataError
from nrs_design.identification.spec_document import spec_changes
from nrs_design.identification.tissue.identify import identify_tissue
from nrs_design.identification.write_spec import law_to_write
from nrs_design.models.contact import Elastic, KelvinVoigt
from nrs_design.spec import parse_spec, read_spec
from nrs_design.spec.environment import KelvinBoltzmannSpec
from tests.identification import motors, signals, synthetic
from tests.identification.support import quick, record, sinusoids, slow
from tests.support import COMMUTING, ROBOT, SOFT_TISSUE, replaced
from tests.tables import rows

SAMPLED = ROBOT / "soft-tissue-sampled.nrs.yaml"


@pytest.fixture(scope="module")
def silicone():
    data = [
        record(Elastic(k), quick(i), noise, i, synthetic.COUNT)
        for i, (k, noise) in enumerate(synthetic.SOFT)
    ]
    return identify_tissue(data, "elastic")


@pytest.fixture(scope="module")
def voigt():
    data = [record(KelvinVoigt(43.0, 1.0), slow(i), 0.1, i, rotational=True) for i in range(3)]
    return identify_tissue(data, "kelvin-voigt")


@pytest.fixture(scope="module")
def motor():
    return identify_actuator(sinusoids(2, (1.2, 2.0, 4.0, 8.0, 14.0)))


@pytest.fixture(scope="module")
def nose():
    """Thesis table 2.4: k1 = 0.233, k2 = 0.972, b = 23.631, here in a linear motion."""
    data = [record(synthetic.NOSE, slow(i), 0.01, i) for i in range(2)]
    return identify_tissue(data, "kelvin-boltzmann")


@pytest.fixture(scope="module")
def late():
    """A motor with a dead time, behind a command that tells it."""
    return identify_actuator([motors.record("PRBS", 1)])


@cache
def delayed(delay):
    return identify_delay(signals.copy(1, delay=delay))


def merge_tissue(*given):
    return write_spec.merge_tissue(*given).text


def merge_actuator(*given):
    return write_spec.merge_actuator(*given).text


def merge_sampling(*given):
    return write_spec.merge_sampling(*given).text


def merged(tmp_path, text):
    path = tmp_path / "copy.nrs.yaml"
    path.write_text(text, newline="")
    return read_spec(path)


def test_only_the_environment_changes(silicone):
    loaded = read_spec(SOFT_TISSUE)
    text = merge_tissue(loaded, silicone, None, None)
    old, new = loaded.text.splitlines(), text.splitlines()
    assert [line for line in old if line not in new] == [
        "    stiffness: {nominal: 747.1461 N/m, range: [720.56 N/m, 768.17 N/m]}"
    ]
    assert len(new) == len(old) + 6


def test_the_range_is_rounded_outwards(silicone):
    spec = parse_spec(merge_tissue(read_spec(SOFT_TISSUE), silicone, "soft", None))
    soft = spec.environments["soft"]
    low, high = soft.stiffness.range
    (wide,) = silicone.model.ranges
    assert low.exact <= Fraction(wide.low) < Fraction(wide.high) <= high.exact
    assert low.exact <= soft.stiffness.nominal.exact <= high.exact
    assert float(low.exact) == pytest.approx(wide.low, rel=2e-5)
    assert [(source.file, source.data) for source in soft.provenance] == [
        (f"record-{i}.csv", "synthetic") for i in range(3)
    ]


def test_one_of_several_environments(silicone):
    loaded = read_spec(ROBOT / "tissue-and-tool.nrs.yaml")
    spec = parse_spec(merge_tissue(loaded, silicone, "stiff", "0.2 m"))
    assert spec.environments["soft"] == loaded.spec.environments["soft"]
    assert spec.environments["stiff"].lever_arm.text == "0.2 m"
    with pytest.raises(SpecError, match="several environments"):
        merge_tissue(loaded, silicone, None, None)
    with pytest.raises(SpecError, match="no environment 'hard'"):
        merge_tissue(loaded, silicone, "hard", None)


@pytest.mark.slow
def test_to_kelvin_voigt_and_back(tmp_path, silicone, voigt):
    text = merge_tissue(read_spec(SOFT_TISSUE), voigt, None, None)
    soft = merged(tmp_path, text).spec.environments["soft"]
    assert soft.model == "kelvin-voigt"
    assert soft.lever_arm is None
    assert soft.damping.nominal.unit == "N*m*s/rad"
    assert "# Thesis 6.3.2.1 asks for a nonzero inertia" in text
    with pytest.raises(SpecError, match="no lever_arm"):
        merge_tissue(merged(tmp_path, text), silicone, None, None)
    back = merge_tissue(merged(tmp_path, text), silicone, None, "0.24 m")
    soft = merged(tmp_path, back).spec.environments["soft"]
    assert (soft.model, soft.lever_arm.text) == ("elastic", "0.24 m")
    assert "# Thesis 6.3.2.1 asks for a nonzero inertia" in back


@pytest.mark.parametrize("stiffness", rows(__file__, "test_comments_within_the_value_stay"))
def test_comments_within_the_value_stay(tmp_path, silicone, stiffness):
    text = SOFT_TISSUE.read_text().replace(
        "stiffness: {nominal: 747.1461 N/m, range: [720.56 N/m, 768.17 N/m]}", stiffness
    )
    new = merge_tissue(merged(tmp_path, text), silicone, None, None)
    assert "# from a catalogue" in new
    assert "700 N/m" not in new


def test_line_ends_stay(tmp_path, silicone):
    loaded = merged(tmp_path, SOFT_TISSUE.read_text().replace("\n", "\r\n"))
    text = merge_tissue(loaded, silicone, None, None)
    assert text.count("\r\n") == text.count("\n")


@pytest.mark.parametrize("file", [SAMPLED, SOFT_TISSUE])
def test_ranges_of_the_actuator_where_the_proof_covers_them(tmp_path, motor, file):
    """Both ranges hold together with 95 %, so that each is wider than its own interval."""
    text = merge_actuator(read_spec(file), motor)
    spec = parse_spec(text)
    assert (spec.actuator.intervals, spec.actuator.range_covers) == (None, "confidence")
    assert spec.actuator.range_id == spec.actuator.values_id()
    for written, own in (
        (spec.actuator.gain, motor.fit.gain),
        (spec.actuator.time_constant, motor.fit.time_constant),
    ):
        low, high = (end.exact for end in written.range)
        assert low < Fraction(own.low) < Fraction(own.high) < high
    assert merge_actuator(merged(tmp_path, text), motor) == text


def test_a_range_that_was_not_there_is_a_change(tmp_path, motor):
    """The proof will cover it, and only the nominal value was told."""
    loaded = merged(tmp_path, SOFT_TISSUE.read_text())
    changed, _ = spec_changes(loaded, merge_actuator(loaded, motor))
    assert any(line.startswith("actuator.gain.range: not there -> [") for line in changed)


def test_a_hand_is_told_by_no_record_of_a_press(tmp_path):
    held = "    model: hand\n    damping: 5 N*s/m\n    mass: 0.1 kg\n"
    hand = merged(tmp_path, SOFT_TISSUE.read_text().replace("    model: elastic\n", held))
    with pytest.raises(
        SpecError, match="soft is a hand, which no record of a press tells"
    ) as caught:
        law_to_write(hand, None, None)
    assert "--model elastic" in caught.value.remedy


DWELL = "switching: {dwell_time: 2 s}"
STATED = """  zero: 56.9706 1/s
  transfer_function: {numerator: [28.416, 1618.80], denominator: [1, 56.89, 1618.80]}"""


@pytest.mark.parametrize(
    ("old", "new"), [("switching: arbitrary", DWELL), ("  zero: 56.9706 1/s", STATED)]
)
def test_intervals_where_no_proof_covers_ranges(tmp_path, motor, old, new):
    """A motor may not change during a dwell time, and is no part of a loop that is stated."""
    plain = SOFT_TISSUE.read_text().replace(", range: [720.56 N/m, 768.17 N/m]", "")
    text = merge_actuator(merged(tmp_path, replaced(plain, (old, new))), motor)
    assert ("intervals" in text, "range_covers" in text) == (True, False)
    # Once a proof does, they give way to ranges.
    again = merge_actuator(merged(tmp_path, text.replace(new, old)), motor)
    assert ("intervals" in again, "range_covers: confidence" in again) == (False, True)


def test_a_dead_time_is_no_age_of_the_force(late):
    """It acts in the motion loop; where the law runs at samples, it has a place of its own."""
    loaded = read_spec(SAMPLED)
    written = parse_spec(merge_actuator(loaded, late))
    assert late.doubts == ()
    assert all("narrower" in doubt for doubt in written.actuator.doubts)
    first, last = (end.exact for end in written.actuator.dead_time[:2])
    assert float(first) <= late.clear_dead_time.low < late.clear_dead_time.high <= float(last)
    assert written.sampling == loaded.spec.sampling


def test_a_dead_time_is_a_doubt_where_no_proof_delays_the_motion_loop(late, tmp_path):
    text = SOFT_TISSUE.read_text()
    written = parse_spec(merge_actuator(merged(tmp_path, text), late))
    assert written.actuator.dead_time is None
    (doubt,) = written.actuator.doubts
    assert "dead time of 0.007" in doubt
    assert "counted from the row in which a command first appears" in doubt


@pytest.mark.slow
def test_delay_in_periods_of_the_processor():
    """1.84 to 3.06 samples of 2 ms are 3.69 to 6.13 periods of 1 ms."""
    found = delayed(signals.DELAY)
    loaded = read_spec(SAMPLED)
    assert parse_spec(merge_sampling(loaded, found)).sampling.delay == (1, 4)
    faster = parse_spec(loaded.text.replace("period: 2 ms", "period: 1 ms"))
    written = parse_spec(merge_sampling(replace(loaded, spec=faster), found)).sampling
    assert (written.delay, written.doubts) == ((3, 7), ())
    assert [source.file for source in written.provenance] == ["pair.csv"]


@pytest.mark.parametrize(
    ("spec", "delay", "error", "message"),
    [
        (SOFT_TISSUE, signals.DELAY, SpecError, "has no sampling"),
        (COMMUTING, signals.DELAY, SpecError, "no place"),
        (SAMPLED, 30.0, DataError, "31 periods"),
    ],
)
def test_what_is_no_age_of_the_force(spec, delay, error, message):
    with pytest.raises(error, match=message) as caught:
        merge_sampling(read_spec(spec), delayed(delay))
    assert caught.value.remedy


@pytest.mark.slow
def test_a_lag_is_no_age_of_the_force():
    with pytest.raises(DataError, match="by a first-order lag") as caught:
        merge_sampling(read_spec(SAMPLED), identify_delay(signals.lag(1)))
    assert caught.value.remedy


def test_the_law_of_the_nose_has_a_place(tmp_path, silicone, nose):
    text = merge_tissue(read_spec(SOFT_TISSUE), nose, None, None)
    soft = merged(tmp_path, text).spec.environments["soft"]
    assert isinstance(soft, KelvinBoltzmannSpec)
    written = (soft.parallel_stiffness, soft.series_stiffness, soft.damping)
    for found, true in zip(written, (0.233, 0.972, 23.631), strict=True):
        assert found.range[0].si <= true <= found.range[1].si
    assert soft.damping.nominal.unit == "N*s/m"
    turned = soft.damping.nominal.exact * Fraction("0.0576")
    assert soft.exact_at_pivot()["damping"].nominal == turned
    back = merge_tissue(merged(tmp_path, text), silicone, None, None)
    assert "parallel_stiffness" not in back


@pytest.mark.slow
def test_doubts_are_noted_and_a_reason_holds_for_them_only(tmp_path, silicone):
    loaded = read_spec(SOFT_TISSUE)
    doubtful = identify_tissue([record(KelvinVoigt(400.0, 60.0), quick(1), 0.02, 1)], "elastic")
    text = merge_tissue(loaded, doubtful, None, None)
    soft = parse_spec(text).environments["soft"]
    assert soft.doubts == doubtful.caveats
    assert (soft.range_covers, soft.accept_doubt) == ("confidence", None)
    accepted = text.replace("    doubts:\n", "    accept_doubt: a phantom\n    doubts:\n")
    again = merge_tissue(merged(tmp_path, accepted), doubtful, None, None)
    assert parse_spec(again).environments["soft"].accept_doubt == "a phantom"
    other = merge_tissue(merged(tmp_path, accepted), silicone, None, None)
    soft = parse_spec(other).environments["soft"]
    assert (soft.doubts, soft.accept_doubt) == ((), None)


@pytest.fixture(scope="module")
def volts():
    return identify_actuator([replace(motors.record("PRBS", 1), unit="V")])


def test_a_gain_per_volt_is_never_written_beside_one_in_rpm(volts):
    with pytest.raises(SpecError, match="commands in V, and derivative_gain is 2060 rpm") as error:
        merge_actuator(read_spec(SOFT_TISSUE), volts)
    assert "remove derivative_gain" in error.value.remedy


def test_a_motor_that_takes_volts(tmp_path, volts, motor):
    plain = SOFT_TISSUE.read_text().replace("  derivative_gain: 2060 rpm*s/rad\n", "")
    text = merge_actuator(merged(tmp_path, plain), volts)
    spec = parse_spec(text)
    assert spec.actuator.command == "V"
    assert all(end.unit == "rad/s/V" for end in spec.actuator.gain.range)
    assert spec.actuator.gain.nominal.si == pytest.approx(volts.fit.gain.value, rel=1e-5)
    # And back to rpm.
    back = parse_spec(merge_actuator(merged(tmp_path, text), motor))
    assert (back.actuator.command, back.actuator.gain.nominal.unit) == ("rpm", "rad/s/rpm")


def test_friction_in_another_unit(tmp_path, volts):
    text = SAMPLED.read_text().replace("  derivative_gain: 2060 rpm*s/rad\n", "")
    text = text.partition("\ndisturbances:")[0] + "\ndisturbances: {friction: 55 rpm}\n"
    with pytest.raises(SpecError, match="friction is 55 rpm"):
        merge_actuator(merged(tmp_path, text), volts)
