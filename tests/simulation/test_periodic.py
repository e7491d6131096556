import math
from fractions import Fraction

import numpy as np
import pytest

from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Switching
from nrs_design.simulation.periodic import mixture_matrix, periodic_run, time_of_growth
from tests.simulation.systems import reset, system

SHEARS = system([[-1, 10], [0, -1]], [[-1, 0], [10, -1]])


def test_radius_of_two_scalar_modes():
    run = periodic_run(system([[-1]], [[3]]), [(0, 1.0), (1, 1.0)])
    assert run.radius == pytest.approx(math.exp(2))
    assert run.period == 2.0
    state = run.response.state[:, 0]
    assert abs(state[-1] / state[0]) == pytest.approx(
        math.exp(2 * round(run.response.time[-1] / 2))
    )


def test_word_in_discrete_time_takes_whole_steps():
    word = system(
        [["7/10", "7/10"], [0, "7/10"]], [["7/10", 0], ["7/10", "7/10"]], time=Time.DISCRETE
    )
    run = periodic_run(word, [(0, 1.0), (1, 1.0)])
    assert run.radius == pytest.approx(0.49 * (3 + math.sqrt(5)) / 2)
    assert run.response.time[:3].tolist() == [0.0, 1.0, 2.0]
    assert run.response.mode[:4].tolist() == [0, 1, 0, 1]


def test_resets_act_where_the_signal_switches():
    double = Switching(resets=(reset("m0", "m1", [[4]]),))
    plain, jumping = (
        periodic_run(system([[-1]], [[-1]], switching=rule), [(0, 1.0), (1, 1.0)])
        for rule in (Switching(), double)
    )
    assert jumping.radius == pytest.approx(4 * plain.radius)


def test_slow_growth_ends_after_thirty_periods_and_fast_growth_early():
    slow = periodic_run(system([["1/1000"]]), [(0, 1.0)])
    fast = periodic_run(system([[300]]), [(0, 1.0)])
    assert slow.response.time[-1] == pytest.approx(30)
    assert fast.response.time[-1] == pytest.approx(1)
    assert np.isfinite(fast.response.state).all()


def test_an_average_is_the_weighted_sum():
    weights = (("m0", Fraction(1, 2)), ("m1", Fraction(1, 2)))
    assert mixture_matrix(SHEARS, weights) == pytest.approx(np.array([[-1, 5], [5, -1]]))


@pytest.mark.parametrize("time", list(Time))
def test_one_unstable_mode_grows_a_hundredfold(time):
    modes = system([[2, 0], [0, "3/2"]], time=time)
    run = periodic_run(modes, [(0, time_of_growth(2.0, modes))]).response
    assert 99 <= np.linalg.norm(run.state[-1]) <= 1100


def test_a_mode_at_the_border_keeps_its_size():
    swing = system([[0, -1], [1, 0]])
    run = periodic_run(swing, [(0, time_of_growth(1j, swing))]).response
    assert np.linalg.norm(run.state, axis=1) == pytest.approx(1.0)
    assert run.time[-1] > 60


def test_the_reset_that_is_chosen_acts():
    both = (reset("m0", "m1", [[1]]), reset("m0", "m1", [[10]]))
    pair = system([[-1]], [[-1]], switching=Switching(resets=both))
    radii = [periodic_run(pair, [(0, 1.0), (1, 1.0)], edges).radius for edges in ((0, 0), (1, 0))]
    assert radii[1] == pytest.approx(10 * radii[0])
    assert radii[0] == pytest.approx(np.exp(-2))
