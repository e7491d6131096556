"""Goals in a spec: what is read, and what is refused with its place."""

from fractions import Fraction

import pytest

from tests.spec.samples import FORCE, IMPEDANCE, interaction, place_of, refusal, spoiled

ALL = (
    "goals: {max_sensitivity_peak: 2, min_gain_margin: '5/2', min_phase_margin: 30 deg, "
    "min_delay_margin: 5 ms, min_disk_margin: 0.7, max_impedance_error: 1.5}\n"
)


def with_goals(text, sample=IMPEDANCE):
    return spoiled(sample, "switching: arbitrary", f"{text}switching: arbitrary")


def test_goals_are_read_with_their_units():
    goals = interaction(with_goals(ALL)).goals
    assert goals.max_sensitivity_peak == 2
    assert float(goals.min_gain_margin) == 2.5
    assert goals.min_phase_margin.si == pytest.approx(0.5235988)
    assert float(goals.min_delay_margin.exact) == 0.005
    assert goals.max_force_error is None
    assert len(dict(goals.given())) == 6


def test_a_goal_of_the_impedance_is_refused_for_force_control():
    text = with_goals("goals: {max_impedance_error: 2}\n", sample=FORCE)
    error = refusal(text)
    assert "for impedance controllers" in error.message
    assert (error.line, error.column) == place_of(text, "2}\nswitching")
    assert interaction(with_goals("goals: {max_force_error: 0.6}\n", sample=FORCE)).goals


def test_goals_without_a_controller_in_contact_are_refused():
    text = IMPEDANCE.partition("controllers:")[0]
    text += "controllers: {position: {type: position}}\ngoals: {min_gain_margin: 2}\n"
    error = refusal(text + "switching: arbitrary\n")
    assert "no controller that a goal applies to" in error.message


def test_a_torque_is_wanted_only_where_something_causes_one():
    error = refusal(with_goals("goals: {peak_torque: 0.3 N*m}\n"))
    assert "nothing is said to disturb" in error.message
    friction = "sampling: {period: 2 ms, delay: 1}\ndisturbances: {friction: 5 rpm}\n"
    error = refusal(with_goals("goals: {peak_torque: 0.3 N*m}\n" + friction))
    assert "of a loop without a command" in error.message
    assert interaction(with_goals(friction)).disturbances.friction
    spec = interaction(
        with_goals("goals: {peak_torque: 0.3 N*m}\ndisturbances: {command: 8 deg/s}\n")
    )
    assert float(spec.goals.peak_torque.exact) == 0.3


def test_a_delay_is_wanted_only_of_a_sampled_loop():
    error = refusal(with_goals("goals: {delay: 4 ms}\n"))
    assert "has no samples" in error.message
    assert "min_delay_margin" in error.remedy
    spec = interaction(with_goals("goals: {delay: 4 ms}\nsampling: {period: 2 ms, delay: 1}\n"))
    assert spec.goals.delay.exact == Fraction(4, 1000)
    assert spec.sampling.oldest == Fraction(2, 1000)


RESPONSES = """goals:
  transparency: {max_impedance: 3 N*m*s/rad, band: [0 Hz, 1 Hz]}
  accuracy: {max_error: 0.1, band: [1 rad/s, 1 Hz], environment: soft}
"""


def test_goals_for_frequency_responses_are_those_of_impedance_controllers():
    spec = interaction(with_goals(RESPONSES))
    assert spec.goals.transparency.limit == 3
    assert spec.goals.accuracy.limit == Fraction(1, 10)
    assert "for impedance controllers" in refusal(with_goals(RESPONSES, sample=FORCE)).message


def test_a_band_ends_below_half_the_sampling_rate():
    """Samples every 0.5 s: half the rate is 1 Hz."""
    sampled = RESPONSES + "sampling: {period: 0.5 s, delay: 0}\n"
    error = refusal(with_goals(sampled))
    assert "half the sampling rate is 1 Hz" in error.message
    assert "below 1 Hz" in error.remedy
    assert interaction(with_goals(sampled.replace("1 Hz]", "0.99 Hz]")))
