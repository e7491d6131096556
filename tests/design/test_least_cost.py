"""What a cost does not fall below: by hand, beside a dense grid, and cut off."""

from fractions import Fraction
from math import log10

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from nrs_design.design.least_cost import Frequency, cost_at_most, least_cost

ONE, HALF = Fraction(1), Fraction(1, 2)


def frequency(omega, F, target, drawn=0):
    real, imag = (Fraction(part) for part in (F.real, F.imag))
    return Frequency(Fraction(omega), Fraction(drawn), real, imag, Fraction(target))


# An integrator with a little damping, at three frequencies; t is half of L at Bt = 2.
SOME = [frequency(w, complex(0.5, -4 / w), 0.3, drawn=0.25) for w in (1.0, 2.0, 4.0)]


def cost(frequencies, weights, Mt, Bt):
    total = 0.0
    for f in frequencies:
        y = Bt + 1j * (Mt * float(f.omega) - float(f.drawn))
        L = abs(y / (y + complex(f.real, f.imag)))
        away = abs(np.log10(float(f.target)) / 2 - np.log10(L))
        total = total + float(weights[0]) * away + float(weights[1]) * L
    return total / len(frequencies)


def test_by_hand():
    """With F = 1, no mass and all weight on L, L = Bt/(1 + Bt) is least at the end."""
    box = (Fraction(0), Fraction(0)), (ONE, Fraction(3))

    def found(enough, most):
        given = [frequency(1, 1 + 0j, 1)]
        return least_cost(given, (Fraction(0), ONE), *box, enough=Fraction(enough), most=most)

    assert found("0.499", 100).below == Fraction("0.499")
    # A better bound than the least value is not found, however long the search.
    beyond = found("0.501", 101)
    assert Fraction("0.499") < beyond.below <= HALF
    assert beyond.boxes == 101


def test_a_displayed_impedance_that_is_met_costs_nothing():
    """With F = 1 and t = 1/2, Bt = 1 is what is wanted: log10 of 1 is 0."""
    given = [frequency(1, 1 + 0j, Fraction(1, 4))]
    weights = ONE, Fraction(0)
    assert cost_at_most(given, weights, Fraction(0), ONE) < Fraction(1, 10**15)
    double = cost_at_most(given, weights, Fraction(0), Fraction(2))
    assert 0 <= double - Fraction(log10(4 / 3)) < Fraction(1, 10**15)


@pytest.mark.parametrize("weights", [(HALF, HALF), (ONE, Fraction(0)), (Fraction(0), ONE)])
@pytest.mark.parametrize("Mt", [(Fraction(0), ONE), (Fraction(1, 4), Fraction(1, 4))])
def test_no_point_of_a_dense_grid_beats_the_bound(weights, Mt):
    Bt = Fraction(1, 10), Fraction(10)
    grid = np.meshgrid(
        np.linspace(*map(float, Mt), 61), np.geomspace(*map(float, Bt), 801), indexing="ij"
    )
    least = cost(SOME, weights, *grid).min()
    enough = Fraction(least) - Fraction(1, 1000)
    found = least_cost(SOME, weights, Mt, Bt, enough=enough, most=4000)
    assert found.below <= Fraction(least)
    # Between the points of the grid it may be a little less, but not here by a thousandth.
    assert found.below == enough


PARTS = st.floats(-4, 4).filter(lambda x: abs(x) > 0.1)


@settings(max_examples=60)
@given(
    st.lists(st.tuples(PARTS, PARTS, st.floats(0.05, 2), st.floats(0, 1)), min_size=1, max_size=3),
    st.floats(0, 1),
    st.floats(0.5, 5),
    st.sampled_from([0.002, 0.05, 0.4]),
    st.sampled_from([(HALF, HALF), (ONE, Fraction(0)), (Fraction(0), ONE), (ONE, ONE / 5)]),
)
def test_one_box_is_bounded_by_what_is_least_in_it(parts, M, B, width, weights):
    """And the closer, the smaller it is."""
    all_given = [frequency(k, complex(a, b), t, d) for k, (a, b, t, d) in enumerate(parts, 1)]
    Mt, Bt = ((Fraction(low), Fraction(low + width)) for low in (M, B))
    ends = (np.linspace(low, low + width, 41) for low in (M, B))
    all_of_it = cost(all_given, tuple(map(float, weights)), *np.meshgrid(*ends))
    least, most = all_of_it.min(), all_of_it.max()
    assume(least > 0.05 and most < 20)
    found = least_cost(all_given, weights, Mt, Bt, enough=Fraction(least * 1.02), most=1).below
    assert found <= least + 1e-9
    if width < 0.01:
        assert found >= least - 4 * (most - least) - 1e-6


def test_a_resonance_in_the_box_does_no_harm():
    """Where ``y + F`` is zero, L is infinite and nothing is small."""
    given = [frequency(1, complex(-1, 0), 1)]
    box = (Fraction(0), Fraction(0)), (HALF, Fraction(2))
    found = least_cost(given, (Fraction(0), ONE), *box, enough=Fraction("0.9"), most=200)
    assert found.below == Fraction("0.9")
    # Near enough for slopes, which are infinite over the whole box.
    near = least_cost(given, (Fraction(0), ONE), *box, enough=Fraction("0.6"), most=200)
    assert near.below == Fraction("0.6")
    # L = Bt/|Bt - 1| is at least 1, at Bt = 1/2.
    at_once = least_cost(given, (Fraction(0), ONE), *box, enough=Fraction("0.9"), most=1)
    assert 0 <= at_once.below <= 1
    assert at_once.boxes == 1


def test_a_cut_off_search_says_less():
    box = (Fraction(0), ONE), (Fraction(1, 10), Fraction(10))
    bounds = [
        least_cost(SOME, (HALF, HALF), *box, enough=ONE, most=most).below for most in (1, 9, 99)
    ]
    assert bounds == sorted(bounds)
    assert bounds[0] < bounds[-1] < cost(SOME, (0.5, 0.5), 0.5, 1.0)


def test_the_cost_of_one_pair_is_that_in_floating_point():
    for Mt, Bt in ((Fraction(0), ONE), (HALF, Fraction(3))):
        above = cost_at_most(SOME, (HALF, HALF), Mt, Bt)
        assert float(above) == pytest.approx(
            cost(SOME, (0.5, 0.5), float(Mt), float(Bt)), rel=1e-12
        )
