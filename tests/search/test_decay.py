import numpy as np
import pytest

from nrs_design.proof.mode import Time
from nrs_design.search.decay import (
    RESOLUTION,
    SMALLEST,
    bisect_position,
    climb_position,
    fastest_first,
    limit_rate,
    rate_of,
)
from nrs_design.search.lmi import find_common_quadratic
from nrs_design.search.rounding import BACK_OFFS, rate_at, round_rate
from nrs_design.work import Allowance, Cost, NotAffordableError

PAIR = np.array([[[-1.0, -1.0], [1.0, -1.0]], [[-1.0, -5.0], [0.2, -1.0]]])


# How exactly a position is found where it is not told otherwise.
FINE = 2.0**-14


def largest_position(matrices, limit, allowance=None):
    """The largest position at which there is a common quadratic function."""

    def is_feasible(position):
        rate = rate_at(position, limit, Time.CONTINUOUS)
        found = find_common_quadratic(matrices, Time.CONTINUOUS, rate, allowance=allowance)
        return found is not None

    return bisect_position(is_feasible, 0.0, FINE)


def test_slowest_mode_limits_the_rate():
    modes = np.array([np.diag([-1.0, -2.0]), np.diag([-3.0, -0.5])])
    assert limit_rate(modes, Time.CONTINUOUS) == 0.5
    assert limit_rate(modes / 10, Time.DISCRETE) == pytest.approx(0.3)
    assert np.isnan(limit_rate(np.full((1, 2, 2), np.inf), Time.CONTINUOUS))


def test_positions_run_from_stability_to_the_limit():
    assert [rate_at(s, 4.0, Time.CONTINUOUS) for s in (0.0, 0.5, 1.0)] == [0.0, 2.0, 4.0]
    contractions = [rate_at(s, 0.2, Time.DISCRETE) for s in (0.0, 0.5, 1.0)]
    assert contractions == pytest.approx([1.0, 0.6, 0.2])


def test_position_of_dayawansa_martin():
    """The pair shifted by alpha is a scaled pair; the threshold falls where it must."""
    position = largest_position(PAIR, 1.0)
    assert position == pytest.approx(0.1056, abs=2e-4)


@pytest.mark.parametrize("rate", [0.1, 0.7])
def test_rate_shown_by_a_function(rate):
    Q = np.array([[2.0, 0.5], [0.5, 1.0]])
    assert rate_of(-rate * np.eye(2)[None], Q, Time.CONTINUOUS) == pytest.approx(rate)
    assert rate_of(rate * np.eye(2)[None], Q, Time.DISCRETE) == pytest.approx(rate)


def test_indefinite_functions_show_nothing():
    with pytest.raises(np.linalg.LinAlgError):
        rate_of(PAIR, np.diag([1.0, -1.0]), Time.CONTINUOUS)


@pytest.mark.parametrize("threshold", [0.999, 0.5, 0.3, 1e-6, 2 * SMALLEST])
def test_position_is_bracketed_relative_to_itself(threshold):
    position = bisect_position(lambda s: s <= threshold)
    assert threshold * (1 - 2 * RESOLUTION) <= position <= threshold


@pytest.mark.parametrize("threshold", [0.0, SMALLEST / 4])
def test_nothing_feasible_ends(threshold):
    assert bisect_position(lambda s: s <= threshold) == 0.0


def test_a_position_is_bracketed_to_a_difference():
    tried = []
    position = bisect_position(lambda s: tried.append(s) or s <= 0.3, 0.0, 2.0**-8)
    assert 0.3 - 2.0**-8 <= position <= 0.3
    assert len(tried) == 8


@pytest.mark.parametrize("time", list(Time))
def test_solutions_come_fastest_first(time):
    """Feasible up to a position of 0.8: every claim is a short rate on the safe side of it."""
    limit = 2.0 if time is Time.CONTINUOUS else 0.5
    best = rate_at(0.8, limit, time)

    def solve(rate, allowance):
        feasible = rate <= best if time is Time.CONTINUOUS else rate >= best
        return rate if feasible else None

    found = list(fastest_first(solve, limit, time, Allowance()))
    assert all(solution == float(claim) == round_rate(claim, time) for solution, claim in found)
    claims = [claim for _, claim in found]
    assert claims == sorted(claims, reverse=time is Time.CONTINUOUS)
    assert len(claims) == len(BACK_OFFS)
    assert float(claims[0]) == pytest.approx(best, rel=1e-3)


def test_the_search_for_the_best_rate_takes_half_of_the_work():
    allowance = Allowance(10.0)

    def solve(rate, allowance):
        allowance.take(Cost(1.0), "a step")
        return rate

    found = fastest_first(solve, 1.0, Time.CONTINUOUS, allowance)
    assert next(found)[1] < 1
    assert allowance.left == pytest.approx(4.0)


def test_a_bisection_without_work_keeps_what_it_has():
    assert largest_position(PAIR, 1.0, Allowance(0.0)) == 0.0
    # Enough for some of the steps of the bisection only.
    allowance = Allowance(0.04)
    some = largest_position(PAIR, 1.0, allowance)
    assert 0.0 < some < largest_position(PAIR, 1.0)

    tried = []

    def is_feasible(position):
        tried.append(position)
        if len(tried) > 2:
            raise NotAffordableError("no time")
        return position < 0.6

    assert bisect_position(is_feasible) == 0.5


@pytest.mark.parametrize("threshold", [0.02, 0.3, 0.8, 0.999, 1.0])
@pytest.mark.parametrize("power", [1.0, 2.0, 3.0])
def test_a_climb_asks_few_positions(threshold, power):
    """What is shown lies between what is asked and the largest, however margins fall."""
    asked = []

    def answer(position):
        asked.append(position)
        if position >= threshold:
            return None
        left = threshold - position
        return left**power, position + left / 3

    found = climb_position(answer, answer(0.0), 2.0**-7, 2.0**-14)
    assert threshold - 2.0**-6 <= found <= threshold
    assert len(asked) <= 14


def test_a_climb_without_work_keeps_what_was_shown():
    def broke(position):
        raise NotAffordableError("no more")

    assert climb_position(broke, (1.0, 0.25), 2.0**-7, 2.0**-14) == 0.25
    assert climb_position(broke, (1.0, -0.25), 2.0**-7, 2.0**-14) == 0.0
