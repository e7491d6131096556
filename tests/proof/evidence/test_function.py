"""What all functions that decrease have in common."""

from fractions import Fraction

import pytest

from nrs_design.proof.evidence.abstract import Shows
from nrs_design.proof.evidence.function import is_square
from nrs_design.proof.mode import Time
from tests.proof.graphs import common_quadratic
from tests.proof.systems import genuine

TINY = Fraction(1, 10**30)


@pytest.mark.parametrize(
    ("rate", "continuous", "discrete"),
    [
        (Fraction(0), False, False),
        (-TINY, False, False),
        (TINY, True, True),
        (1 - TINY, True, True),
        (Fraction(1), True, False),
        (1 + TINY, True, False),
    ],
)
def test_a_rate_of_decay_is_positive_and_in_steps_below_one(rate, continuous, discrete):
    evidence = common_quadratic(((1,),), 0, rate)
    assert (evidence.find_rate_misfit(Time.CONTINUOUS) is None) is continuous
    assert (evidence.find_rate_misfit(Time.DISCRETE) is None) is discrete


def test_functions_show_stability_at_the_rate_that_they_claim():
    system, evidence = genuine("common-quadratic")
    assert evidence.shows is Shows.STABILITY
    assert evidence.attains_rate
    assert evidence.proved_rate(system) == evidence.rate


@pytest.mark.parametrize(
    ("M", "square"),
    [
        ([[1]], False),
        ([[1, 2], [3, 4]], True),
        ([[1, 2], [3]], False),
        ([[1, 2], [3, 4], [5, 6]], False),
        ([[1, 2, 3], [4, 5, 6]], False),
    ],
)
def test_as_many_rows_and_columns_as_asked_for(M, square):
    assert is_square(M, 2) is square
