"""The processor in a spec: period, delay, and what has no room in the sampled loop."""

from fractions import Fraction

import pytest

from nrs_design.errors import SpecError
from nrs_design.spec import InteractionDesignSpec, parse_spec
from nrs_design.spec.describe import describe
from tests.support import SOFT_TISSUE

TEXT = SOFT_TISSUE.read_text(encoding="utf-8")


def sampled(section: str, text: str = TEXT) -> InteractionDesignSpec:
    spec = parse_spec(f"{text}\nsampling: {section}\n")
    assert isinstance(spec, InteractionDesignSpec)
    return spec


@pytest.mark.parametrize(
    ("written", "delay"), [("0", (0, 0)), ("2", (2, 2)), ("[0, 2]", (0, 2)), ("[1, 1]", (1, 1))]
)
def test_reads_a_delay_or_its_range(written, delay):
    sampling = sampled(f"{{period: 2 ms, delay: {written}}}").sampling
    assert sampling.period.exact == Fraction(1, 500)
    assert sampling.delay == delay
    assert sampling.admittance == "exact"


@pytest.mark.parametrize(
    ("section", "said"),
    [
        ("{period: 2 ms}", "`sampling.delay` is missing"),
        ("{delay: 1}", "`sampling.period` is missing"),
        ("{period: 0 ms, delay: 1}", "must be positive"),
        ("{period: 2, delay: 1}", "no unit"),
        ("{period: 2 ms, delay: 1.5}", "a delay of 1.5 is no whole number of samples"),
        (
            "{period: 2 ms, delay: -1}",
            "a delay of -1 samples is not modelled (write a number of samples from 0 to 10",
        ),
        ("{period: 2 ms, delay: [0, 11]}", "a delay of 11 samples is not modelled"),
        ("{period: 2 ms, delay: [2, 0]}", "ends below its start"),
        ("{period: 2 ms, delay: [0, 1, 2]}", "two of them"),
        ("{period: 2 ms, delay: 2 ms}", "'2 ms' is a time, and a delay counts samples"),
        ("{period: 1 kHz, delay: 1}", "that is a frequency: write the time, one over it"),
        ("2 ms", "write sampling: {period: ..., delay: ...}"),
        ("{period: 2 ms, delay: 1, admittance: tustin}", "admittance"),
    ],
)
def test_refuses_with_place_and_remedy(section, said):
    with pytest.raises(SpecError) as caught:
        sampled(section)
    assert said in f"{caught.value.message} ({caught.value.remedy})"
    assert caught.value.line is not None


RANGED = TEXT.replace(
    "time_constant: 0.0351 s",
    "time_constant: {nominal: 0.0351 s, range: [0.034 s, 0.036 s]}",
)


LOADED = TEXT.replace(
    "time_constant: 0.0351 s", "time_constant: 0.0351 s\n  load_inertia: 1 kg*m^2"
)
POSITION = "  held: {type: position}\n"


def test_ranges_of_the_actuator_are_for_impedance_controllers_with_and_without_samples():
    for spec in (sampled("{period: 2 ms, delay: 0}", RANGED), parse_spec(RANGED)):
        assert [end.exact for end in spec.actuator.time_constant.range] == [
            Fraction("0.034"),
            Fraction("0.036"),
        ]
    mixed = "idle_states: {decay: 20 1/s}\n"
    for text, what in ((RANGED, "the time_constant has a range"), (LOADED, "load_inertia")):
        both = text.replace("controllers:\n", f"controllers:\n{POSITION}") + mixed
        with pytest.raises(SpecError, match=rf"{what}.*impedance controllers alone, and 'held'"):
            parse_spec(both)


def test_a_load_of_the_motor_is_for_continuous_time():
    assert parse_spec(LOADED).actuator.load_inertia.exact == 1
    with pytest.raises(SpecError, match="not modelled in the sampled loop"):
        sampled("{period: 2 ms, delay: 0}", LOADED)
    with pytest.raises(SpecError, match="load_inertia"):
        parse_spec(LOADED.replace("1 kg*m^2", "0 kg*m^2"))


def test_a_motor_that_may_change_and_a_dwell_time_exclude_each_other():
    with pytest.raises(SpecError, match="a dwell time and a range of the actuator"):
        parse_spec(RANGED.replace("switching: arbitrary", "switching: {dwell_time: 1 s}"))


def test_ranges_of_the_actuator_do_not_go_with_a_stated_loop():
    loop = "  transfer_function: {numerator: [28, 1600], denominator: [1, 57, 1600]}\n"
    text = RANGED.replace("motion_loop:\n", f"motion_loop:\n{loop}")
    with pytest.raises(SpecError, match="states the closed motion loop itself"):
        sampled("{period: 2 ms, delay: 0}", text)


def test_check_lists_what_the_processor_does():
    rows = {row[0]: row for row in describe(sampled("{period: 2 ms, delay: [0, 2]}", RANGED))}
    assert rows["sampling.period"][1] == "2 ms"
    assert rows["sampling.delay"][1] == "[0, 2]"
    assert rows["contact"][1] == "not said: the claim tells"
    assert rows["actuator.time_constant.range"][1] == "[0.034 s, 0.036 s]"


@pytest.mark.parametrize(
    ("section", "said"),
    [
        ("{friction: 55.3 rpm}", "without sampling, friction is not modelled"),
        ("{command: 8 deg/s, largest_angle: 20 deg}", "without sampling, largest_angle is not"),
        ("{}", "no disturbance is named"),
    ],
)
def test_what_may_disturb_a_loop_in_continuous_time(section, said):
    with pytest.raises(SpecError, match=said):
        parse_spec(f"{TEXT}\ndisturbances: {section}\n")


def test_the_largest_angle_may_stand_alone():
    spec = sampled("{period: 2 ms, delay: 0}\ndisturbances: {largest_angle: 20 deg}")
    assert spec.disturbances.largest_angle.text == "20 deg"
    assert spec.disturbances.bounds() == {}


@pytest.mark.parametrize(
    ("word", "meant"),
    [("perod", "period"), ("sample_time", "period"), ("Ts", "period"), ("rate", "period"),
     ("delays", "delay"), ("lag", "delay"), ("latency", "delay"), ("age", "delay")],
)  # fmt: skip
def test_a_wrong_key_is_told_by_the_one_that_is_meant(word, meant):
    """Once, and not also as a key that is missing; what `identify` writes comes last."""
    section = "{period: 2 ms, delay: 1}".replace(meant, word)
    with pytest.raises(SpecError) as caught:
        sampled(section)
    message = str(caught.value)
    assert f"unknown key `sampling.{word}`" in message
    assert "is missing" not in message
    assert f"did you mean {meant}? keys here are period, delay, " in message
