"""Evidence of kind constants-quadratic: published bounds, the argument, attacks."""

from dataclasses import replace
from fractions import Fraction

import pytest

from nrs_design.proof.evidence import ConstantsQuadratic
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.switching import Switching
from nrs_design.search.certify import Verdict, certify
from nrs_design.search.method import Method
from tests.proof.systems import companion, family, genuine, matrix, oscillator, shears
from tests.proof.truth import holds

KINDS = ("constants-quadratic", "constants-quadratic, continuous")
PAIR = Switching(fixed_ends=(("m0", "m1"),))
# de Oliveira, Bernussou and Geromel, A new discrete-time robust stability condition, Systems &
# Control Letters 37 (1999): A + B a C with one uncertain a, abs(a) up to a bound.
A0 = [["0.8", "-0.25", 0, 1], [1, 0, 0, 0], [0, 0, "0.2", "0.03"], [0, 0, 1, 0]]
C = ["0.8", "-0.5", 0, 1]


def published(bound, switching=PAIR):
    ends = []
    for a in (-Fraction(bound), Fraction(bound)):
        rows = [[Fraction(v) for v in row] for row in A0]
        rows[2] = [v + a * Fraction(c) for v, c in zip(rows[2], C, strict=True)]
        ends.append(rows)
    return family(*ends, time=Time.DISCRETE, switching=switching)


@pytest.mark.parametrize(
    ("bound", "quadratic", "constants"),
    [
        ("0.427", True, True),
        ("0.429", False, True),
        ("0.461", False, True),
        ("0.463", False, False),
    ],
)
def test_published_bounds(bound, quadratic, constants):
    """Quadratic stability ends at 0.4279, the condition at 0.4619 as stability itself does."""
    varying = certify(published(bound, Switching()), Method.LMI)
    assert (varying.verdict is Verdict.PROVED) is quadratic
    constant = certify(published(bound), Method.CONSTANTS_QUADRATIC)
    assert (constant.verdict is Verdict.PROVED) is constants
    if constants:
        assert holds(constant.system, constant.evidence)


def test_two_constants_where_a_jump_is_unstable():
    """By Jury's criterion every constant pair is stable; of jumps, a period of two grows."""
    found = certify(companion("0.9", "0.95"))
    assert found.verdict is Verdict.PROVED
    assert found.evidence.kind == "constants-quadratic"
    assert holds(found.system, found.evidence)
    assert certify(companion("0.9", "0.95", Switching())).verdict is Verdict.REFUTED


@pytest.mark.parametrize("kbar", [7, 50, 1000])
def test_a_constant_stiffness_is_stable_however_large(kbar):
    """Unstable for a stiffness that jumps, once kbar > 6.98513 (Zelentsovsky 1994)."""
    found = certify(oscillator(kbar, PAIR))
    assert found.verdict is Verdict.PROVED
    # All eigenvalues have the real part -1/2.
    assert 0 < found.evidence.rate <= Fraction(1, 2)
    assert holds(found.system, found.evidence)
    assert certify(oscillator(kbar)).verdict is Verdict.REFUTED


@pytest.mark.parametrize("kind", KINDS)
def test_functions_and_multipliers_belong_to_their_corners(kind):
    """The function of one corner is none of the opposite one; a turned multiplier is another."""
    system, evidence = genuine(kind)
    ((F, G),) = evidence.multipliers
    turned = tuple(zip(*F, strict=True)), tuple(tuple(-v for v in row) for row in G)
    assert replace(evidence, multipliers=(turned,)).find_fault(system) is not None
    opposite = replace(evidence, functions=evidence.functions[::-1])
    assert opposite.find_fault(system) is not None
    (corners,) = system.switching.fixed_ends
    ends = replace(system, switching=Switching(fixed_ends=(corners[::-1],)))
    assert evidence.find_fault(ends) is not None
    assert opposite.find_fault(ends) is None


def test_multipliers_of_each_corner_alone_prove_nothing():
    """Both shears are stable and their mean is not: only multipliers in common are refused."""
    k = Fraction(1000)
    system = shears(PAIR)
    for log2 in (0, 4):
        for P in (((1, 0), (0, 100)), ((100, 0), (0, 1)), ((1, 0), (0, 1))):
            for G in (((1, 0), (0, 1)), ((k.numerator, 0), (0, 1))):
                item = ConstantsQuadratic((P, P), ((P, G),), log2, Fraction(1, 1000))
                assert item.find_fault(system) is not None
    assert certify(system).verdict is not Verdict.PROVED


def test_the_claim_is_that_of_its_time():
    """Steps decrease by rho^t, and continuous time by exp(-alpha t)."""
    for kind, law in zip(KINDS, ("x+ = A x,", "x' = A x,"), strict=True):
        system, evidence = genuine(kind)
        claim = evidence.claim(system)
        assert law in claim
        assert ("rho^t" in claim) == ("x+" in law) != ("exp(-alpha t)" in claim)


def test_one_mode_at_all_corners_is_stable_or_not():
    """A mode that no constant parameter is in has to decrease all functions."""
    system, _ = genuine("constants-quadratic")
    corners = system.switching.fixed_ends[0]
    for entry, verdict in (("0.1", True), ("1.1", False)):
        modes = (*system.modes, Mode("b", matrix([[entry, 0], [0, entry]])))
        sets = Switching(fixed_ends=(corners, ("b",) * 4))
        found = certify(replace(system, modes=modes, switching=sets))
        assert (found.verdict is Verdict.PROVED) is verdict


def test_forms_by_hand():
    """One state 1/2 and 1/4 with P = 3 and 5, F = 1, G = 4, at the rate 9/10."""
    system = family([["1/2"]], [["1/4"]], time=Time.DISCRETE, switching=PAIR)
    item = ConstantsQuadratic((((3,),), ((5,),)), ((((1,),), ((4,),)),), 0, Fraction(9, 10))
    *_, first, second = (form for _, form in item.forms(system))
    for form, P, a, d in ((first, 3, Fraction(1, 2), 2), (second, 5, Fraction(1, 4), 4)):
        expected = [[Fraction(81, 100) * P - 2 * a, 1 - 4 * a], [1 - 4 * a, 8 - P]]
        assert form == [[v * d * 100 for v in row] for row in expected]
    flow = family([[-1]], [["-1/2"]], switching=PAIR)
    item = replace(item, rate=Fraction(1, 3))
    *_, first, second = (form for _, form in item.forms(flow))
    for form, P, a, d in ((first, 3, Fraction(-1), 1), (second, 5, Fraction(-1, 2), 2)):
        expected = [[-2 * a - Fraction(2, 3) * P, 1 - P - 4 * a], [1 - P - 4 * a, 8]]
        assert form == [[v * d * 3 for v in row] for row in expected]
