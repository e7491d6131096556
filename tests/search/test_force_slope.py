"""The least bound in floating point is that of the evidence, and its slope that of the bound."""

import pytest

from nrs_design.proof.channels import Output
from nrs_design.search.rate_slope import force_slope
from nrs_design.work import Allowance, NotAffordableError
from tests.proof.systems import dayawansa_martin, family, matrix, pushed
from tests.search.test_invariant_ellipsoid import bounded


def found_of(system, share=None):
    return force_slope(system, system.outputs[0], Allowance(), share)


def test_it_is_the_bound_of_the_evidence():
    system = pushed(dayawansa_martin(4))
    assert float(bounded(system).level) == pytest.approx(found_of(system).level, rel=5e-3)


def test_the_slope_is_that_of_the_bound():
    at, near, far = (pushed(dayawansa_martin(a)) for a in ("4", "4.004", "4.2"))
    found = found_of(at)
    whole = found_of(far).level / found.level - 1
    assert 50 * found.change(near) == pytest.approx(whole, rel=0.15)


def test_a_share_that_was_the_best_is_a_good_guess():
    system = pushed(dayawansa_martin(4))
    found = found_of(system)
    assert found_of(system, found.share).level <= found.level * 1.001
    # One that is of no use is not taken.
    assert found_of(system, 1e9).level == pytest.approx(found.level, rel=1e-3)


def test_growth_has_no_bound():
    system = pushed(family([[1, 0], [0, -1]], [[-1, 0], [0, -2]]))
    assert found_of(system) is None


def test_a_budget_is_kept():
    system = pushed(dayawansa_martin(4))
    with pytest.raises(NotAffordableError):
        force_slope(system, Output("x", "m", (matrix([[1, 0]]),) * 2), Allowance(1e-9))
