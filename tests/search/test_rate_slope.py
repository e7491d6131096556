"""The best rate of one form, and its slope: of systems where both are known, and by differences."""

from dataclasses import replace
from fractions import Fraction

import pytest

from nrs_design.proof.channels import Output
from nrs_design.proof.mode import Time
from nrs_design.search.rate_slope import RESOLUTION, force_slope, may_have_slope, rate_slope
from nrs_design.search.work import Allowance, NotAffordableError
from tests.proof import systems
from tests.search.test_invariant_ellipsoid import bounded

PERIOD = Fraction(1, 100)


def diagonal(a, b):
    """Two modes that share their eigenvectors: the rate is that of the slowest entry."""
    return systems.family([[-Fraction(a), 0], [0, -3]], [[-2, 0], [0, -Fraction(b)]])


def in_steps(system):
    """The same in steps of 10 ms, by Euler's method."""
    modes = [
        [[(i == j) + PERIOD * entry for j, entry in enumerate(row)] for i, row in enumerate(rows)]
        for rows in (mode.A.fractions() for mode in system.modes)
    ]
    return replace(systems.family(*modes, time=Time.DISCRETE), sample_time=PERIOD)


def test_the_slowest_entry_is_the_rate():
    for system in (diagonal(1, 4), in_steps(diagonal(1, 4))):
        found = rate_slope(system)
        assert found.rate == pytest.approx(1, rel=2 * RESOLUTION)


def test_only_the_slowest_entry_has_a_slope():
    found = rate_slope(diagonal(1, 4))
    assert found.change(diagonal("1.01", 4)) == pytest.approx(0.01, rel=0.02)
    assert found.change(diagonal(1, "4.1")) == pytest.approx(0, abs=1e-4)


@pytest.mark.parametrize("shape", [lambda system: system, in_steps])
@pytest.mark.parametrize(
    ("make", "at"), [(systems.dayawansa_martin, "4"), (systems.oscillator, "2")]
)
def test_the_slope_is_that_of_the_rate(make, at, shape):
    near = Fraction(at) * Fraction(101, 100)
    far = Fraction(at) * Fraction(105, 100)
    found = rate_slope(shape(make(at)), resolution=1e-6)
    change = rate_slope(shape(make(far)), resolution=1e-6).rate - found.rate
    assert 5 * found.change(shape(make(near))) == pytest.approx(change, rel=0.1)


def test_it_is_negative_where_no_form_shows_decay():
    """Dayawansa and Martin 1999: there is a common quadratic function iff a < 3 + sqrt(8)."""
    below, above = (rate_slope(systems.dayawansa_martin(a)) for a in ("5.8", "5.86"))
    assert below.rate > 0 > above.rate
    assert below.change(systems.dayawansa_martin("5.86")) < -below.rate


def test_growth_is_a_negative_rate():
    found = rate_slope(systems.family([[Fraction(1, 2), 0], [0, -3]], [[-2, 1], [0, -1]]))
    assert found.rate == pytest.approx(-0.5, rel=1e-2)
    steps = rate_slope(in_steps(systems.family([[Fraction(1, 2), 0], [0, -3]], [[-2, 1], [0, -1]])))
    assert steps.rate == pytest.approx(-0.5, rel=1e-2)


def test_a_guess_changes_little():
    rates = [
        rate_slope(systems.dayawansa_martin(4), guess).rate
        for guess in (None, 1e-3, 0.1, 10.0, -1.0)
    ]
    assert rates == pytest.approx([rates[0]] * len(rates), rel=4 * RESOLUTION)


def test_where_contact_is_lost():
    system = replace(systems.bouncing_in_steps("0.5"), sample_time=PERIOD)
    assert may_have_slope(system)
    assert rate_slope(system) is not None


@pytest.mark.parametrize("system", [systems.bouncing_in_turns(), systems.lossy_network()])
def test_what_has_none(system):
    """Unlike one form for all modes: forms of turns, and of modes under rules."""
    assert not may_have_slope(system)


def test_numbers_beyond_floating_point_have_no_slope():
    assert rate_slope(systems.family([[-(10**400), 0], [0, -1]])) is None


def test_a_budget_is_kept():
    with pytest.raises(NotAffordableError):
        rate_slope(systems.dayawansa_martin(4), allowance=Allowance(1e-6))


def found_of(system, share=None):
    return force_slope(system, system.outputs[0], Allowance(), share)


def test_it_is_the_bound_of_the_evidence():
    system = systems.pushed(systems.dayawansa_martin(4))
    assert float(bounded(system).level) == pytest.approx(found_of(system).level, rel=5e-3)


def test_the_slope_is_that_of_the_bound():
    at, near, far = (systems.pushed(systems.dayawansa_martin(a)) for a in ("4", "4.004", "4.2"))
    found = found_of(at)
    whole = found_of(far).level / found.level - 1
    assert 50 * found.change(near) == pytest.approx(whole, rel=0.15)


def test_a_share_that_was_the_best_is_a_good_guess():
    system = systems.pushed(systems.dayawansa_martin(4))
    found = found_of(system)
    assert found_of(system, found.share).level <= found.level * 1.001
    # One that is of no use is not taken.
    assert found_of(system, 1e9).level == pytest.approx(found.level, rel=1e-3)


def test_growth_has_no_bound():
    system = systems.pushed(systems.family([[1, 0], [0, -1]], [[-1, 0], [0, -2]]))
    assert found_of(system) is None


def test_the_budget_of_a_bound_is_kept():
    system = systems.pushed(systems.dayawansa_martin(4))
    with pytest.raises(NotAffordableError):
        force_slope(system, Output("x", "m", (systems.matrix([[1, 0]]),) * 2), Allowance(1e-9))
