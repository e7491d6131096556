"""Evidence of kind no-common-quadratic: thresholds, the trace argument, and attacks."""

from dataclasses import replace
from fractions import Fraction

import pytest

from nrs_design.proof.contact import Contact
from nrs_design.proof.evidence import NoCommonQuadratic
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time
from tests.proof.systems import family, genuine, matrix


def test_denominators_without_a_common_one_are_refused():
    coprime = enumerate((2**40_000, 3**20_000))
    modes = tuple(Mode(f"m{i}", RationalMatrix(((1,),), q)) for i, q in coprime)
    system = replace(family([[1]]), modes=modes)
    evidence = NoCommonQuadratic((("m0", ((1,),)), ("m1", ((1,),))))
    assert evidence.find_fault(system) == "the numbers of the modes are too large to check"
    assert replace(evidence, factors=evidence.factors[:1]).find_fault(system) is None


def test_it_says_nothing_of_rates_and_takes_no_contact_for_granted():
    system, evidence = genuine("no-common-quadratic")
    assert evidence.proved_rate(system) is None
    assert str(evidence.shows) == "no common quadratic function"
    losable = replace(system, contact=Contact((Mode("f", matrix([[-1, 0], [1, 0]])),)))
    assert evidence.claim(losable) == evidence.claim(system)


@pytest.mark.parametrize(
    ("time", "value"),
    [
        # Twice A X for X = 4 and 9, and A^2 X - X; all over 6^2.
        (Time.CONTINUOUS, 36 * 2 * (Fraction(1, 2) * 4 - Fraction(2, 3) * 9)),
        (Time.DISCRETE, 36 * ((Fraction(1, 4) - 1) * 4 + (Fraction(4, 9) - 1) * 9)),
    ],
)
def test_the_sum_by_hand(time, value):
    system = family([["1/2"]], [["-2/3"]], time=time)
    evidence = NoCommonQuadratic((("m0", ((2,),)), ("m1", ((3,),))))
    ((_, form),) = evidence.forms(system)
    assert form == [[value]]


@pytest.mark.parametrize("time", Time)
def test_the_sum_of_two_states_by_hand(time):
    """``A = [[1, 2], [0, 3]] / 2`` and ``L = (1, 2)'``: ``X = [[1, 2], [2, 4]]``."""
    system = family([["1/2", 1], [0, "3/2"]], time=time)
    ((_, form),) = NoCommonQuadratic((("m0", ((1,), (2,))),)).forms(system)
    # A L = (5/2, 3), and both times four.
    if time is Time.CONTINUOUS:
        assert form == [[4 * 5, 4 * 8], [4 * 8, 4 * 12]]
    else:
        assert form == [[25 - 4, 30 - 8], [30 - 8, 36 - 16]]
