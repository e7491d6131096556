"""The processor in a spec: period, delay, and what has no room in the sampled loop."""

from fractions import Fraction

import pytest

from nrs_design.errors import SpecError
from nrs_design.spec import InteractionDesignSpec, parse_spec
from tests.support import SOFT_TISSUE, replaced

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


RANGED = TEXT.replace(
    "time_constant: 0.0351 s", "time_constant: {nominal: 0.0351 s, range: [0.034 s, 0.036 s]}"
)


def test_ranges_of_the_actuator_are_for_impedance_controllers_with_and_without_samples():
    for spec in (sampled("{period: 2 ms, delay: 0}", RANGED), parse_spec(RANGED)):
        assert [end.exact for end in spec.actuator.time_constant.range] == [
            Fraction("0.034"),
            Fraction("0.036"),
        ]


def test_the_largest_angle_may_stand_alone():
    spec = sampled("{period: 2 ms, delay: 0}\ndisturbances: {largest_angle: 20 deg}")
    assert spec.disturbances.largest_angle.text == "20 deg"
    assert spec.disturbances.bounds() == {}


OUTER = "\nsampling: {period: 2 ms, outer_period: 0.1 ms, delay: 0}\n"


def read(text, *changes):
    return parse_spec(replaced(text, *changes))


@pytest.mark.parametrize(
    ("outer", "round_", "step"),
    [
        ("0.1 ms", 20, "1/10000"),
        ("2 ms", 1, "1/500"),
        ("10 ms", 5, "1/500"),
        ("0.04 ms", 50, "1/25000"),
    ],
)
def test_periods_that_meet(outer, round_, step):
    sampling = read(TEXT + OUTER.replace("0.1 ms", outer)).sampling
    assert (sampling.round, sampling.step) == (round_, Fraction(step))
    assert sampling.outer == sampling.outer_period.exact


def test_a_delay_counts_samples_of_the_force():
    text = TEXT + OUTER.replace("delay: 0", "delay: [0, 3]")
    assert read(text).sampling.oldest == Fraction(3, 10_000)
    assert read(text, (", outer_period: 0.1 ms", "")).sampling.oldest == Fraction(3, 500)


@pytest.mark.parametrize(
    ("drive", "written", "unit"),
    [
        ("velocity_interface: {time_constant: 0.02 s}", "0.02 rad/s", "rad/s"),
        ("position_interface: {time_constant: 0.02 s}", "1 mrad", "rad"),
    ],
)
def test_friction_is_in_the_unit_of_the_command(drive, written, unit):
    """Of each drive, whatever it takes; the rpm of a driver are no velocity."""
    start = TEXT.index("actuator:")
    text = TEXT[:start] + drive + TEXT[TEXT.index("\nlimits:") :]
    more = "sampling: {period: 2 ms, delay: 0}\ncontact: kept\ndisturbances: {friction: %s}\n"
    spec = parse_spec(f"{text}\n{more % written}")
    assert spec.disturbances.bounds()["friction"][1] == unit == spec.command
    with pytest.raises(SpecError, match=f"and the motor takes {unit}"):
        parse_spec(f"{text}\n{more % '2 rpm'}")
