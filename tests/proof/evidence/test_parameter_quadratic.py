"""Evidence of kind parameter-quadratic: constant parameters, the condition in between, attacks."""

from dataclasses import replace
from fractions import Fraction

import pytest

from nrs_design.proof.evidence import ParameterQuadratic
from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Switching
from nrs_design.search.certify import Verdict, certify
from tests.proof.systems import (
    family,
    genuine,
    oscillator,
    resets_between,
    shears,
)
from tests.proof.truth import holds

PAIR = Switching(fixed_ends=(("m0", "m1"),))
I2 = ((1, 0), (0, 1))


@pytest.mark.parametrize("kbar", [7, 50, 1000])
def test_a_constant_stiffness_is_stable_however_large(kbar):
    # x'' + x' + (2 + k) x: unstable for k that jumps, once kbar > 6.98513.
    found = certify(oscillator(kbar, PAIR))
    assert found.verdict is Verdict.PROVED
    # All eigenvalues have the real part -1/2.
    assert 0 < found.evidence.rate <= Fraction(1, 2)
    assert holds(found.system, found.evidence)
    assert certify(oscillator(kbar)).verdict is Verdict.REFUTED


def test_both_ends_and_the_middle_are_needed():
    # Both ends of the shears are Hurwitz, the middle is not.
    system = shears(PAIR)
    for k in (1, 10, 100, 1000):
        tall, flat = ((1, 0), (0, k)), ((k, 0), (0, 1))
        for low, high in ((tall, flat), (flat, tall), (tall, tall), (I2, I2)):
            evidence = ParameterQuadratic(low, high, 0, Fraction(1, 1000))
            assert evidence.find_fault(system) is not None
    assert certify(system).verdict is not Verdict.PROVED


def test_the_condition_in_between_is_the_one_that_fails():
    # [[1, 0], [0, k]] suits the first shear for k > 25, and the second by symmetry.
    low, high = ((1, 0), (0, 100)), ((100, 0), (0, 1))
    evidence = ParameterQuadratic(low, high, 0, Fraction(1, 1000))
    assert "between" in str(evidence.find_fault(shears(PAIR)))


def test_denominators_of_the_two_ends_do_not_weigh():
    # A = -I/3 and B = -I/7: every mixed term counts with its own denominator.
    for rate, fault in (("0.14", False), ("1/7", True), ("0.2", True)):
        system = family([["-1/3", 0], [0, "-1/3"]], [["-1/7", 0], [0, "-1/7"]], switching=PAIR)
        evidence = ParameterQuadratic(I2, I2, 0, Fraction(rate))
        assert (evidence.find_fault(system) is not None) is fault


@pytest.mark.parametrize("denominators", [(1, 4), (4, 1), (1, 3), (8, 6)])
@pytest.mark.parametrize("rate", ["1/8", "1/6", "3/16"])
def test_the_mixed_condition_weighs_both_ends_alike(denominators, rate):
    # Scalars -a and -b with Q = 1 and h: a h + b - rate (1 + h) > 0 is the mixed condition.
    a, b = (1 + Fraction(1, d) - 1 // d for d in denominators)
    system = family([[-a]], [[-b]], switching=PAIR)
    for h in (1, 2, 7):
        evidence = ParameterQuadratic(((1,),), ((h,),), 0, Fraction(rate))
        forms = dict(evidence.forms(system))
        mixed = forms["V does not decrease between m0 and m1"][0][0]
        first = forms["V does not decrease in mode m0"][0][0]
        ratio = (2 * a * h + 2 * b - 2 * Fraction(rate) * (1 + h)) / (2 * a - 2 * Fraction(rate))
        assert Fraction(mixed, first) == ratio


def test_every_mode_is_one_end_of_one_pair():
    _, evidence = genuine("parameter-quadratic")
    rows = [mode.A.fractions() for mode in oscillator(50).modes]
    for ends in (
        (),
        (("m0", "m1"),),
        (("m0", "m1"), ("m0", "m1")),
        (("m0", "m0"), ("m1", "m2")),
        (("m0", "m1"), ("m2", "m9")),
    ):
        system = family(*rows, [[1, 0], [0, 1]], switching=Switching(fixed_ends=ends))
        assert evidence.find_fault(system) is not None


def test_swapped_ends_are_another_system():
    system, evidence = genuine("parameter-quadratic")
    swapped = replace(system, switching=Switching(fixed_ends=(("m1", "m0"),)))
    assert evidence.find_fault(swapped) is not None
    turned = replace(evidence, low=evidence.high, high=evidence.low)
    assert turned.find_fault(swapped) is None


def test_pairs_of_modes_switch_at_one_value():
    rows = [mode.A.fractions() for mode in oscillator(50).modes]
    more_damped = [[[0, 1], [A[1][0], Fraction(-11, 10)]] for A in rows]
    ends = Switching(fixed_ends=(("m0", "m1"), ("m2", "m3")))
    found = certify(family(*rows, *more_damped, switching=ends))
    assert found.verdict is Verdict.PROVED
    assert found.evidence.kind == "parameter-quadratic"
    assert holds(found.system, found.evidence)


def test_resets_and_discrete_time_are_not_covered():
    system, evidence = genuine("parameter-quadratic")
    resets = resets_between(("m0", "m1", [[1, 0], [0, 1]]))
    with_resets = replace(system, switching=replace(PAIR, resets=resets))
    assert evidence.find_fault(with_resets) is not None
    assert "continuous" in str(evidence.find_fault(replace(system, time=Time.DISCRETE)))


def test_it_proves_nothing_about_a_parameter_that_moves():
    system, evidence = genuine("parameter-quadratic")
    assert evidence.find_fault(replace(system, switching=Switching())) is not None


@pytest.mark.parametrize("rate", ["0", "-1/8", "1/2", "7"])
def test_rates(rate):
    system, evidence = genuine("parameter-quadratic")
    assert replace(evidence, rate=Fraction(rate)).find_fault(system) is not None


@pytest.mark.parametrize("end", ["low", "high"])
@pytest.mark.parametrize("Q", [((1, 0),), ((1, 0), (0,)), (), ((1,),)])
def test_both_ends_of_q_have_the_size_of_the_state(end, Q):
    system, evidence = genuine("parameter-quadratic")
    assert replace(evidence, **{end: Q}).find_fault(system) == "Q is not a 2 x 2 matrix"


@pytest.mark.parametrize("end", ["low", "high"])
def test_both_ends_of_q_are_positive(end):
    system, evidence = genuine("parameter-quadratic")
    fault = replace(evidence, **{end: ((1, 0), (0, 0))}).find_fault(system)
    assert fault == f"Q at the {end} end is not symmetric and positive definite"


def test_forms_by_hand():
    """Scalars -1/2 and -1/3 with Q = 5 and 7 at the rate 1/5, all over the denominator 6."""
    system = family([["-1/2"]], [["-1/3"]], switching=PAIR)
    evidence = ParameterQuadratic(((5,),), ((7,),), 0, Fraction(1, 5))
    low, high, at_low, at_high, between = (form[0][0] for _, form in evidence.forms(system))
    assert (low, high) == (5, 7)
    factor = 6 * 5
    assert at_low == factor * 2 * 5 * (Fraction(1, 2) - Fraction(1, 5))
    assert at_high == factor * 2 * 7 * (Fraction(1, 3) - Fraction(1, 5))
    slow = 7 * (Fraction(1, 2) - Fraction(1, 5)) + 5 * (Fraction(1, 3) - Fraction(1, 5))
    assert between == factor * 2 * slow


def test_a_denominator_out_of_range_is_refused():
    system, evidence = genuine("parameter-quadratic")
    for log2 in (-1, 10**6):
        odd = replace(evidence, denominator_log2=log2)
        assert "the denominator of Q" in odd.find_fault(system)


def test_the_claim_counts_the_modes_of_a_value():
    system, evidence = genuine("parameter-quadratic")
    assert "switching arbitrarily among the one mode at that value" in evidence.claim(system)
    pairs = Switching(fixed_ends=(("m0", "m1"), ("m2", "m3")))
    rows = [mode.A.fractions() for mode in system.modes] * 2
    assert "among the 2 modes at that value" in evidence.claim(family(*rows, switching=pairs))
