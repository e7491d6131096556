"""Each condition is needed: families that grow although all conditions but one hold.

Of kinds whose conditions take more room, the tests of the kind have such families.
"""

from fractions import Fraction

import pytest

from nrs_design.proof.evidence import (
    CommonPolynomial,
    CommonQuadratic,
    ModePolynomial,
    ModeQuadratic,
)
from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Switching
from nrs_design.search.certify import Verdict, certify
from tests.proof.systems import family, resets_between
from tests.support import is_definite_by_ldl

HALF, STEPS = Fraction(1, 2), Time.DISCRETE
PLUS, MINUS, ZERO = ((1,),), ((-1,),), ((0,),)
# Eightfold at one of two switches: 8/4 a round, though each mode halves the state at every step.
LEAP = Switching(resets=resets_between(("m0", "m1", [[8]])))
LEAPING = family([["1/2"]], [["1/2"]], time=STEPS, switching=LEAP)
RATE = Fraction(3, 4)


def by_mode(*functions):
    named = tuple((f"m{i}", Q) for i, Q in enumerate(functions))
    return ModeQuadratic(named, 0, RATE)


CASES = {
    "common-quadratic, Q": (family([[1]]), CommonQuadratic(MINUS, 0, HALF), "positive definite"),
    "common-quadratic, a mode": (
        family([[-1]], [[1]]),
        CommonQuadratic(PLUS, 0, HALF),
        "in mode m1",
    ),
    "common-quadratic, a step": (
        family([["1/4"]], [[2]], time=STEPS),
        CommonQuadratic(PLUS, 0, HALF),
        "in mode m1",
    ),
    "common-polynomial, Q": (
        family([[1]]),
        CommonPolynomial(2, MINUS, 0, (ZERO,), HALF),
        "positive definite",
    ),
    "common-polynomial, a mode": (
        family([[-1]], [[1]]),
        CommonPolynomial(2, PLUS, 0, (ZERO, ZERO), HALF),
        "in mode m1",
    ),
    "mode-quadratic, Q": (family([[2]], time=STEPS), by_mode(MINUS), "positive definite"),
    "mode-quadratic, a mode": (
        family([["1/2"]], [[2]], time=STEPS, switching=Switching(transitions=())),
        by_mode(PLUS, PLUS),
        "m1",
    ),
    "mode-quadratic, a switch": (LEAPING, by_mode(PLUS, PLUS), "m0"),
    "mode-polynomial, Q": (
        family([[2]], time=STEPS),
        ModePolynomial(2, by_mode(MINUS), (ZERO,)),
        "positive definite",
    ),
    "mode-polynomial, a switch": (
        LEAPING,
        ModePolynomial(2, by_mode(PLUS, PLUS), (ZERO,) * 4),
        "m0",
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_one_condition_fails_and_the_family_grows(name):
    system, evidence, words = CASES[name]
    assert evidence.find_misfit(system) is None
    failing = [why for why, form in evidence.forms(system) if not is_definite_by_ldl(form)]
    assert len(failing) == 1
    assert words in failing[0]
    assert failing[0] in evidence.find_fault(system)
    assert certify(system).verdict is Verdict.REFUTED
