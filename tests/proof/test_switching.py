from fractions import Fraction

import numpy as np
import pytest

from nrs_design.proof.switching import Reset, Stay, Switching
from tests.proof.systems import matrix, resets_between

HALF = Fraction(1, 2)


def test_dwell_time_of_numpy_becomes_one_of_python():
    switching = Switching(np.int64(3))
    assert switching == Switching(Fraction(3))
    assert type(switching.dwell_time.numerator) is int


@pytest.mark.parametrize(
    "rules",
    [
        {"dwell_time": HALF},
        {"transitions": ()},
        {"resets": (Reset("m0", "m1", matrix([[1]])),)},
        {"fixed_ends": (("m0", "m1"),)},
        {"stays": (("m0", Stay()),)},
    ],
)
def test_any_rule_ends_arbitrary_switching(rules):
    assert Switching().is_arbitrary
    assert not Switching(**rules).is_arbitrary


def test_nothing_said_leaves_stays_free():
    assert Stay() == Stay(Fraction(0), None)


def test_maps_of_resets_by_their_switch():
    rules = Switching(
        resets=resets_between(("m0", "m1", [[2]]), ("m1", "m0", [[5]]), ("m0", "m1", [[3]]))
    )
    assert rules.maps() == {
        ("m0", "m1"): [matrix([[2]]), matrix([[3]])],
        ("m1", "m0"): [matrix([[5]])],
    }
