"""The logic as it runs: what is proved about the time between two switches, seen in runs."""

from dataclasses import replace
from fractions import Fraction
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.controllers.step_logic import StepLogic
from nrs_design.spec.threshold_logic import ThresholdLogicSpec
from tests.tables import entry

PERIOD, NOISE, RATE = 1e-3, 0.1, 40.0
SPEC = ThresholdLogicSpec.model_validate(entry(__file__, "SPEC"))
LOGIC = StepLogic.create(SPEC, ("in", "out"), Fraction(1, 1000))
NO_TIMER = replace(LOGIC, hold_samples=(0, 0))


def switch_times(logic, values):
    """Times of all switches, for values of the command that the logic sees."""
    (mode, held), times = (logic.start, 0), []
    for k, value in enumerate(values):
        before = mode
        mode, held = logic.step(mode, held, {"command": value})
        if mode != before:
            times.append(k * PERIOD)
    return times


def seen(moves, ages, errors):
    """What the logic sees of a command that moves by at most its rate, from 1 ms to 1 ms."""
    true = [0.0]
    for move in moves:
        true.append(true[-1] + move * RATE * PERIOD)
    return [
        true[max(0, k - age)] + error * NOISE
        for k, (age, error) in enumerate(zip(ages, errors, strict=True))
    ]


share = st.floats(-1, 1)


@given(st.data())
def test_no_two_switches_are_closer_without_any_timer(data):
    """Under any noise, age and motion within the bounds: the theorem, and that it is not vacuous.

    Motion keeps its direction for a while, so that thresholds are reached.
    """
    length, moves = 120, []
    while len(moves) < length:
        moves += [data.draw(share)] * data.draw(st.integers(1, 50))
    ages = data.draw(st.lists(st.integers(0, 4), min_size=length, max_size=length))
    errors = data.draw(st.lists(share, min_size=length, max_size=length))
    times = switch_times(NO_TIMER, seen(moves[: length - 1], ages, errors))
    least = float(SPEC.tightest("in").seconds)
    assert all(b - a >= least - 1e-9 for a, b in pairwise(times))


def test_the_bound_is_reached():
    """Noise that helps, an age that jumps from 4 ms to nothing: 16 ms, and no less."""
    moves = [-1.0] * 11 + [1.0] * 64
    values = seen(moves, [4] * 16 + [0] * 60, [-1.0] * 16 + [1.0] * 60)
    first, second = switch_times(NO_TIMER, values)[:2]
    assert second - first == pytest.approx(0.016, abs=3 * PERIOD)


@given(st.lists(st.floats(allow_nan=True), min_size=1, max_size=200))
def test_the_timer_holds_whatever_the_signals_do(values):
    times = [0.0, *switch_times(LOGIC, values)]
    assert all(b - a >= 0.016 - 1e-9 for a, b in pairwise(times))
