"""Evidence of kind no-common-quadratic: thresholds, the trace argument, and attacks."""

from dataclasses import replace
from fractions import Fraction

import pytest

from nrs_design.proof.contact import Contact
from nrs_design.proof.evidence import NoCommonQuadratic
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.switching import Switching
from tests.proof.systems import ando_shih, dayawansa_martin, family, genuine

IDENTITY = ((1, 0), (0, 1))


@pytest.mark.parametrize("example", ["no-common-quadratic", "no-common-quadratic, discrete"])
def test_it_is_never_shown_for_a_family_that_has_one(example):
    _, evidence = genuine(example)
    for easy in (dayawansa_martin(5), ando_shih("0.7")):
        assert evidence.find_fault(easy) is not None


def test_a_hurwitz_mode_alone_has_a_function_whatever_the_factors():
    system = family([[-1, 100], [0, -1]])
    for L in (IDENTITY, ((1,), (0,)), ((3, -5), (2, 7)), ((0,), (0,))):
        assert NoCommonQuadratic((("m0", L),)).find_fault(system) is not None


def test_multipliers_cannot_be_negative():
    # X = -I would "show" it for -I; a factor L makes X = L L' whatever its sign.
    system = family([[-1, 0], [0, -1]])
    assert NoCommonQuadratic((("m0", ((-1, 0), (0, -1))),)).find_fault(system) is not None


def test_it_says_nothing_about_stability_and_holds_under_any_switching():
    system, evidence = genuine("no-common-quadratic")
    for switching in (Switching(transitions=()), Switching(fixed_ends=(("m0", "m1"),))):
        assert evidence.find_fault(replace(system, switching=switching)) is None
    assert evidence.proved_rate(system) is None
    assert str(evidence.shows) == "no common quadratic function"


def test_denominators_without_a_common_one_are_refused():
    coprime = enumerate((2**40_000, 3**20_000))
    modes = tuple(Mode(f"m{i}", RationalMatrix(((1,),), q)) for i, q in coprime)
    system = replace(family([[1]]), modes=modes)
    evidence = NoCommonQuadratic((("m0", ((1,),)), ("m1", ((1,),))))
    assert evidence.find_fault(system) == "the numbers of the modes are too large to check"
    assert replace(evidence, factors=evidence.factors[:1]).find_fault(system) is None


def test_a_statement_about_matrices_takes_no_contact_for_granted():
    system, evidence = genuine("no-common-quadratic")
    free = RationalMatrix.from_rows([[-1, 0], [1, 0]])
    losable = replace(system, contact=Contact((Mode("f", free),)))
    assert evidence.find_fault(losable) is None
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


def test_every_factor_is_of_a_mode_and_has_rows_of_one_length():
    system = family([[1, 0], [0, 1]], [[1, 0], [0, 1]])
    good = ("m0", IDENTITY)
    assert NoCommonQuadratic((good,)).find_fault(system) is None
    assert NoCommonQuadratic((good, ("m1", ((1,), (0,))))).find_fault(system) is None
    for name in ("m2", "m0"):
        factors = (good, (name, IDENTITY))
        assert NoCommonQuadratic(factors).find_fault(system) == "the factors are not those of modes"
    for L in (((1, 0),), ((1, 0), (0, 1), (0, 0)), ((1, 0), (0,))):
        fault = NoCommonQuadratic((good, ("m1", L))).find_fault(system)
        assert fault == "a factor does not have 2 rows of one length"
    for factors in ((), (("m0", ((), ())),)):
        assert NoCommonQuadratic(factors).find_fault(system) is not None


def test_the_claim_is_that_of_the_time():
    evidence = NoCommonQuadratic(())
    assert "satisfies A'Q + QA < 0 for all modes" in evidence.claim(family([[1]]))
    assert "satisfies A'QA < Q for all modes" in evidence.claim(family([[1]], time=Time.DISCRETE))
