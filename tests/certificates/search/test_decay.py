import numpy as np
import pytest

from nrs_design.certificates.search.allowance import Allowance, NotAffordableError
from nrs_design.certificates.search.decay import (
    RESOLUTION,
    SMALLEST,
    TOLERANCE,
    bisect_position,
    largest_position,
    limit_rate,
    rate_at,
    rate_of,
)
from nrs_design.switched.system import Time

PAIR = np.array([[[-1.0, -1.0], [1.0, -1.0]], [[-1.0, -5.0], [0.2, -1.0]]])


def test_slowest_mode_limits_the_rate():
    modes = np.array([np.diag([-1.0, -2.0]), np.diag([-3.0, -0.5])])
    assert limit_rate(modes, Time.CONTINUOUS) == 0.5
    assert limit_rate(modes / 10, Time.DISCRETE) == pytest.approx(0.3)
    assert np.isnan(limit_rate(np.full((1, 2, 2), np.inf), Time.CONTINUOUS))


def test_positions_run_from_stability_to_the_limit():
    assert [rate_at(s, 4.0, Time.CONTINUOUS) for s in (0.0, 0.5, 1.0)] == [0.0, 2.0, 4.0]
    contractions = [rate_at(s, 0.2, Time.DISCRETE) for s in (0.0, 0.5, 1.0)]
    assert contractions == pytest.approx([1.0, 0.6, 0.2])


def test_commuting_modes_reach_the_limit():
    # Narendra and Balakrishnan 1994: the identity works up to the rate of the slower mode.
    modes = np.array([[[-1.0, 1.0], [-1.0, -1.0]], [[-2.0, 3.0], [-3.0, -2.0]]])
    assert largest_position(modes, Time.CONTINUOUS, 1.0) > 1 - 10 * TOLERANCE


def test_position_of_dayawansa_martin():
    """The pair shifted by alpha is a scaled pair; the threshold falls where it must."""
    position = largest_position(PAIR, Time.CONTINUOUS, 1.0)
    assert position == pytest.approx(0.1056, abs=2e-4)


@pytest.mark.parametrize("rate", [0.1, 0.7])
def test_rate_shown_by_a_function(rate):
    Q = np.array([[2.0, 0.5], [0.5, 1.0]])
    assert rate_of(-rate * np.eye(2)[None], Q, Time.CONTINUOUS) == pytest.approx(rate)
    assert rate_of(rate * np.eye(2)[None], Q, Time.DISCRETE) == pytest.approx(rate)


def test_still_modes_show_the_best_contraction():
    assert rate_of(np.zeros((1, 2, 2)), np.eye(2), Time.DISCRETE) == 0.0


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


def test_a_bisection_without_time_keeps_what_it_has():
    assert largest_position(PAIR, Time.CONTINUOUS, 1.0, Allowance(0.0)) == 0.0
    # Enough for some of the steps of the bisection only.
    allowance = Allowance(0.12, clock=lambda: 0.0)
    some = largest_position(PAIR, Time.CONTINUOUS, 1.0, allowance)
    assert 0.0 < some < largest_position(PAIR, Time.CONTINUOUS, 1.0)

    tried = []

    def is_feasible(position):
        tried.append(position)
        if len(tried) > 2:
            raise NotAffordableError("no time")
        return position < 0.6

    assert bisect_position(is_feasible) == 0.5
