"""Coordinates of stays: in them a period that shrinks is a contraction."""

import numpy as np
import pytest
from scipy.linalg import expm

from nrs_design.search.stays import round_stays
from tests.search.test_pieces import timed

# From a random search: without coordinates of their own, the solver or the rounding fails.
LONG = [[["-4.11", "7.26"], ["-2.15", "4.73"]], [["1.3", "-4.1"], ["2.2", "-5.3"]]]
SLOW = [
    [["-0.5", "2", "0"], ["-2", "-0.5", "1"], ["0", "0", "-0.8"]],
    [["0.2", "0", "1"], ["0", "-0.3", "0"], ["-1", "0.5", "-0.9"]],
]


@pytest.mark.parametrize("matrices", [LONG, SLOW])
def test_a_stay_in_one_mode_and_then_the_other_contracts(matrices):
    system = timed((0, 0), matrices)
    found = {name: one.whole for name, one in round_stays(system, ("a", "b")).items()}
    A, B = (np.array(rows, dtype=float) for rows in matrices)
    period = expm(B * 1.1) @ expm(A * 1.7)
    radius = np.abs(np.linalg.eigvals(period)).max()
    inside = np.linalg.inv(found["a"]) @ period @ found["a"]
    assert np.linalg.norm(inside, 2) < max(1.0, 1.2 * radius)


def test_modes_that_may_stay_have_coordinates_as_well():
    system = timed((0, 0), [[["-1", "5"], ["0", "-2"]], [["-2", "0"], ["4", "-1"]]])
    found = round_stays(system, ("a",))
    assert all(np.linalg.cond(one.whole) < 100 for one in found.values())
