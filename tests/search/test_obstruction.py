"""Search for proofs that no common quadratic function exists."""

import numpy as np
import pytest

from nrs_design.search.family import Family
from nrs_design.search.obstruction import round_obstruction, solve_dual
from tests.proof.systems import ando_shih, dayawansa_martin, oscillator


def dual(system):
    return solve_dual(Family.of(system).matrices, system.time)


@pytest.mark.parametrize(
    "system", [dayawansa_martin("5.83"), oscillator("3.83"), ando_shih("0.71")]
)
def test_multipliers_are_found_just_above_the_thresholds(system):
    multipliers = dual(system)
    evidence = round_obstruction(system, multipliers, Family.of(system).exponents)
    assert evidence.find_fault(system) is None


@pytest.mark.parametrize("system", [dayawansa_martin("5.82"), oscillator("3.82"), ando_shih("0.7")])
def test_nothing_below_them(system):
    multipliers = dual(system)
    if multipliers is not None:
        assert round_obstruction(system, multipliers, Family.of(system).exponents) is None


@pytest.mark.parametrize("lie", [np.nan, np.inf, 0.0, -1.0, 1.0, 1e300, 1e-300])
def test_multipliers_that_lie_give_no_verdict(lie):
    system = dayawansa_martin(5)
    multipliers = np.full((2, 2, 2), lie)
    try:
        evidence = round_obstruction(system, multipliers, np.zeros(2, dtype=np.int64))
    except (np.linalg.LinAlgError, OverflowError, ValueError):
        return
    assert evidence is None
