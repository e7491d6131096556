"""Values as text: never rounded to the side that flatters."""

import math

import pytest

from nrs_design.design.measures import (
    DELAY_MARGIN,
    GAIN_MARGIN,
    IMPEDANCE_ERROR,
    PHASE_MARGIN,
    SENSITIVITY_PEAK,
)


@pytest.mark.parametrize(
    ("measure", "value", "text"),
    [
        (SENSITIVITY_PEAK, 1.59201, "1.593"),
        (SENSITIVITY_PEAK, 2.0000001, "2.001"),
        (SENSITIVITY_PEAK, 2.0, "2"),
        (GAIN_MARGIN, 1.0006999, "1"),
        (GAIN_MARGIN, 5.39999, "5.399"),
        (PHASE_MARGIN, math.radians(29.99999), "29.99 deg"),
        (DELAY_MARGIN, 0.0123456, "12.34 ms"),
        (IMPEDANCE_ERROR, 10.0001, "10.01"),
        (GAIN_MARGIN, math.inf, "unlimited"),
        (SENSITIVITY_PEAK, math.inf, "unbounded"),
        (GAIN_MARGIN, 0.0, "0"),
    ],
)
def test_text_is_rounded_to_the_unfavorable_side(measure, value, text):
    assert measure.text(value) == text


def test_goals_are_written_in_the_units_of_the_spec():
    assert SENSITIVITY_PEAK.goal_text(2.0) == "at most 2"
    assert PHASE_MARGIN.goal_text(math.radians(30)) == "at least 30 deg"
    assert DELAY_MARGIN.goal_text(0.005) == "at least 5 ms"


@pytest.mark.parametrize(
    ("measure", "met", "goal", "missed"),
    [(SENSITIVITY_PEAK, 1.9, 2.0, 2.1), (GAIN_MARGIN, 2.1, 2.0, 1.9)],
)
def test_violation_is_positive_only_where_the_goal_is_missed(measure, met, goal, missed):
    assert measure.violation(met, goal) < 0
    assert measure.violation(goal, goal) == 0
    assert measure.violation(missed, goal) > 0
