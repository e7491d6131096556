"""Search for proofs that no common quadratic function exists."""

import numpy as np
import pytest

from nrs_design.search import obstruction
from nrs_design.search.obstruction import search_obstruction
from tests.proof.systems import ando_shih, dayawansa_martin, oscillator
from tests.search.support import found


@pytest.mark.parametrize(
    "system", [dayawansa_martin("5.83"), oscillator("3.83"), ando_shih("0.71")]
)
def test_multipliers_are_found_just_above_the_thresholds(system):
    assert found(search_obstruction, system).find_fault(system) is None


@pytest.mark.parametrize("system", [dayawansa_martin("5.82"), oscillator("3.82"), ando_shih("0.7")])
def test_nothing_below_them(system):
    assert found(search_obstruction, system) is None


@pytest.mark.parametrize("lie", [np.nan, np.inf, 0.0, -1.0, 1.0, 1e300, 1e-300])
def test_multipliers_that_lie_give_no_verdict(monkeypatch, lie):
    monkeypatch.setattr(obstruction, "solve_dual", lambda *_: np.full((2, 2, 2), lie))
    try:
        evidence = found(search_obstruction, dayawansa_martin(5))
    except (np.linalg.LinAlgError, OverflowError, ValueError):
        return
    assert evidence is None
