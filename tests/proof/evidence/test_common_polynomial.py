"""Evidence of kind common-polynomial: published values, its conditions, and attacks on them."""

from dataclasses import replace
from fractions import Fraction
from math import comb

import pytest

from nrs_design.proof.evidence import CommonPolynomial, read_evidence
from nrs_design.proof.evidence.common_polynomial import lifted_factor
from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Switching
from nrs_design.search.certify import Limits, Verdict, certify
from nrs_design.search.method import Method
from tests.proof.systems import (
    dayawansa_martin,
    family,
    genuine,
    oscillator,
    resets_between,
    robot,
)
from tests.proof.truth import holds
from tests.support import ends_soon


def by_polynomial(system, degree):
    return certify(system, Method.POLYNOMIAL, Limits(max_degree=degree, budget=30))


@pytest.mark.parametrize(
    ("a", "degree"), [("6", 4), ("7", 4), ("10.76", 12), ("11", 20), ("11.1", 24)]
)
def test_pair_of_dayawansa_and_martin_has_a_polynomial(a, degree):
    found = by_polynomial(dayawansa_martin(a), degree)
    assert found.verdict is Verdict.PROVED
    assert 2 * found.evidence.degree <= degree
    # Both modes have the eigenvalues -1 +- j: no function decays faster.
    assert 0 < found.evidence.rate <= 1


def test_quadratic_functions_end_where_published():
    # 3 + 2 sqrt(2) = 5.8284...; degree four begins where degree two ends.
    assert by_polynomial(dayawansa_martin("5.829"), 4).evidence.degree == 2


@pytest.mark.parametrize("a", ["11.262", "11.27", "12"])
def test_no_polynomial_beyond_the_limit_of_stability(a):
    assert by_polynomial(dayawansa_martin(a), 24).verdict is not Verdict.PROVED


@pytest.mark.parametrize(("kbar", "proved"), [("6", True), ("6.7", True), ("6.986", False)])
def test_oscillator_up_to_its_published_limit(kbar, proved):
    # 6.98513 (Zelentsovsky 1994).
    assert (by_polynomial(oscillator(kbar), 20).verdict is Verdict.PROVED) is proved


def test_designs_of_the_robot_by_the_published_degrees():
    tissue = robot("0.01", [("43", "1.04"), ("43", "2.15"), ("62", "1.04"), ("62", "2.15")])
    hand = robot(
        "0",
        [("24.9984", "1.04"), ("24.9984", "2.15"), ("90.432", "1.04"), ("90.432", "2.15")],
    )
    for system, degree in ((tissue, 4), (hand, 6)):
        found = certify(system, limits=Limits(optimize_rate=False))
        assert 2 * found.evidence.degree == degree
        assert found.evidence.find_fault(system) is None


def test_the_rate_cannot_be_raised_beyond_the_slowest_mode():
    system, evidence = genuine("common-polynomial")
    assert replace(evidence, rate=Fraction(1)).find_fault(system) is not None
    assert replace(evidence, rate=Fraction(0)).find_fault(system) is not None
    assert replace(evidence, rate=-evidence.rate).find_fault(system) is not None


def test_a_form_that_does_not_vanish_would_prove_anything():
    # With N = c I the condition always holds: it must be seen that z'Nz is not zero.
    system = dayawansa_martin(12)
    _, evidence = genuine("common-polynomial")
    size = len(evidence.Q)
    N = tuple(tuple(10**9 * (i == j) for j in range(size)) for i in range(size))
    forged = replace(evidence, vanishing=(N, N))
    assert forged.find_fault(system) == "a form that must vanish does not"


def test_vanishing_forms_belong_to_their_modes():
    system, evidence = genuine("common-polynomial")
    assert replace(evidence, vanishing=evidence.vanishing[:1]).find_fault(system) is not None
    swapped = replace(evidence, vanishing=evidence.vanishing[::-1])
    assert swapped.find_fault(system) is not None or holds(system, swapped)


def test_it_does_not_cover_resets():
    system, evidence = genuine("common-polynomial")
    resets = resets_between(("m0", "m1", [[2, 0], [0, 2]]))
    assert evidence.find_fault(replace(system, switching=Switching(resets=resets))) is not None


@pytest.mark.parametrize(
    "switching",
    [
        Switching(Fraction(3)),
        Switching(transitions=(("m0", "m1"),)),
        Switching(fixed_ends=(("m0", "m1"),)),
    ],
)
def test_it_covers_fewer_signals_than_all(switching):
    system, evidence = genuine("common-polynomial")
    assert evidence.find_fault(replace(system, switching=switching)) is None


@pytest.mark.parametrize("degree", [0, -2, 66, 10**300])
def test_degrees_out_of_range_are_rejected_at_once(degree):
    system, evidence = genuine("common-polynomial")
    fields = {"kind": evidence.kind, **evidence.to_fields(), "degree": degree}
    with ends_soon():
        assert read_evidence(fields, system).find_fault(system) is not None


def test_odd_degrees_do_not_exist():
    system, evidence = genuine("common-polynomial")
    with pytest.raises(ValueError, match="odd"):
        read_evidence({"kind": evidence.kind, **evidence.to_fields(), "degree": 5}, system)


@pytest.mark.parametrize(("n", "degree"), [(64, 2), (64, 32), (16, 3)])
def test_lifts_that_nobody_can_check_are_rejected_at_once(n, degree):
    system = family([[-(i == j) for j in range(n)] for i in range(n)])
    evidence = CommonPolynomial(degree, ((1,),), 0, (((0,),),), Fraction(1, 2))
    with ends_soon():
        assert "monomials" in str(evidence.find_fault(system))


def test_giant_integers_do_not_hang():
    system, evidence = genuine("common-polynomial")
    giant = tuple(tuple(q * 10**4000 for q in row) for row in evidence.Q)
    with ends_soon():
        replace(evidence, Q=giant).find_fault(system)


def test_numbers_that_would_take_minutes_are_refused():
    size = comb(7, 4)
    Q = tuple(tuple(2**2400 * (i == j) for j in range(size)) for i in range(size))
    zero = tuple((0,) * size for _ in range(size))
    system = family([[-int(i == j) for j in range(4)] for i in range(4)])
    evidence = CommonPolynomial(4, Q, 0, (zero,), Fraction(1, 2))
    assert evidence.find_fault(system) == "its numbers are too large to check"
    small = tuple(tuple(int(i == j) for j in range(size)) for i in range(size))
    assert replace(evidence, Q=small).find_fault(system) is None


def scalar(degree):
    """The form ``x^(2 d)`` for one mode of one state."""
    return CommonPolynomial(degree, ((1,),), 0, (((0,),),), Fraction(1, 2))


@pytest.mark.parametrize(("degree", "fits"), [(0, False), (1, True), (32, True), (33, False)])
def test_degrees(degree, fits):
    fault = None if fits else f"degree {2 * degree} is not between 2 and 64"
    assert scalar(degree).find_fault(family([[-1]])) == fault


@pytest.mark.parametrize(("n", "degree", "fits"), [(120, 1, True), (121, 1, False), (3, 14, True)])
def test_the_most_monomials(n, degree, fits):
    """There are 120 of degree 14 in three variables."""
    size = comb(n + degree - 1, degree)
    unit, zero = (
        tuple(tuple(c * (i == j) for j in range(size)) for i in range(size)) for c in (1, 0)
    )
    evidence = CommonPolynomial(degree, unit, 0, (zero,), Fraction(1, 2))
    fault = None if fits else f"there are more than 120 monomials of degree {degree}"
    system = family([[-int(i == j) for j in range(n)] for i in range(n)])
    assert evidence.find_misfit(system) == fault


@pytest.mark.parametrize(("time", "bits"), [(Time.CONTINUOUS, 2 + 3), (Time.DISCRETE, 2 + 4 * 3)])
def test_the_longest_numbers(monkeypatch, time, bits):
    """Of Q, two bits, and of the modes, three: in discrete time for each of four factors."""
    limit = "nrs_design.proof.evidence.common_polynomial.MAX_WORK"
    Q, zero = (tuple(tuple(c * (i == j) for j in range(3)) for i in range(3)) for c in (3, 0))
    evidence = CommonPolynomial(2, Q, 0, (zero, zero), Fraction(1, 2))
    short, long = [["-1/9", 0], [0, "-1/9"]], [["-7/9", 0], [0, "-1/9"]]
    for system in (family(long, short, time=time), family(short, long, time=time)):
        monkeypatch.setattr(limit, 3**3 * bits)
        assert evidence.find_misfit(system) is None
        monkeypatch.setattr(limit, 3**3 * bits - 1)
        assert evidence.find_misfit(system) == "its numbers are too large to check"


def test_forms_of_one_state_by_hand():
    """``x' = -2/3 x`` and ``x+ = -2/3 x`` with ``V = 5 x^6``, at the rate 1/2 or 3/4."""
    evidence = CommonPolynomial(3, ((5,),), 0, (((0,),),), Fraction(1, 2))
    A, a = family([["-2/3"]]), Fraction(2, 3)
    (_, Q), (_, form) = evidence.forms(A)
    assert Q == ((5,),)
    factor = lifted_factor(A.modes[0], 3, Fraction(1, 2), Time.CONTINUOUS)
    assert form == [[factor * 5 * 2 * 3 * (a - Fraction(1, 2))]]
    assert evidence.find_fault(A) is None
    assert replace(evidence, rate=a).find_fault(A) is not None
    in_steps, rate = replace(A, time=Time.DISCRETE), Fraction(3, 4)
    _, (_, form) = replace(evidence, rate=rate).forms(in_steps)
    factor = lifted_factor(A.modes[0], 3, rate, Time.DISCRETE)
    assert form == [[factor * 5 * (rate**6 - a**6)]]
    assert replace(evidence, rate=rate).find_fault(in_steps) is None
    assert replace(evidence, rate=a).find_fault(in_steps) is not None


def test_factors_clear_the_denominators():
    (mode,) = family([["-2/3"]]).modes
    # 3 for the mode, and 1 for 2 * 3 * 1/2 * 3; or (3^2)^2 for the mode, and (4^2)^2 for the rate.
    assert lifted_factor(mode, 3, Fraction(1, 2), Time.CONTINUOUS) == 3
    assert lifted_factor(mode, 1, Fraction(1, 7), Time.CONTINUOUS) == 21
    assert lifted_factor(mode, 2, Fraction(3, 4), Time.DISCRETE) == 3**4 * 4**4


@pytest.mark.parametrize("which", [0, 1, 2])
def test_every_form_is_square(which):
    system, evidence = genuine("common-polynomial")
    forms = [evidence.Q, *evidence.vanishing]
    forms[which] = forms[which][:-1]
    fault = replace(evidence, Q=forms[0], vanishing=tuple(forms[1:])).find_fault(system)
    assert fault == "a form is not a 3 x 3 matrix"


def test_every_form_vanishes():
    system, evidence = genuine("common-polynomial")
    for which in (0, 1):
        forms = list(evidence.vanishing)
        forms[which] = evidence.Q
        fault = replace(evidence, vanishing=tuple(forms)).find_fault(system)
        assert fault == "a form that must vanish does not"


def test_the_claim_and_the_file_name_the_degree():
    assert "where |x|^6 is a positive definite form of degree 6 in x" in scalar(3).claim(
        family([[-1]])
    )
    assert scalar(3).to_fields()["degree"] == 6
    assert CommonPolynomial.from_fields(scalar(3).to_fields(), family([[-1]])) == scalar(3)
