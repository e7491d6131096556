"""Polynomials for each mode: what is accepted, and what must not be."""

from dataclasses import replace
from fractions import Fraction

import pytest

from nrs_design.proof.evidence import ModePolynomial, ModeQuadratic
from nrs_design.proof.evidence.mode_polynomial import lift_system
from nrs_design.proof.evidence.mode_quadratic import MAX_DWELL_STEPS
from nrs_design.proof.system import Stay, Switching, Time
from nrs_design.search.certify import Limits, certify
from nrs_design.search.method import Method
from tests.proof.systems import family, genuine, geromel_colaneri, resets_between

SYSTEM, EVIDENCE = genuine("mode-polynomial")


def test_found_evidence_holds():
    assert EVIDENCE.find_fault(SYSTEM) is None
    assert EVIDENCE.degree == 2


def test_the_forms_that_vanish_are_needed():
    """Without them, the lifted modes would have quadratic functions."""
    zero = tuple(tuple((0,) * len(row) for row in N) for N in EVIDENCE.vanishing)
    assert replace(EVIDENCE, vanishing=zero).find_fault(SYSTEM) is not None


def test_a_form_that_does_not_vanish_is_no_help():
    first, *rest = EVIDENCE.vanishing
    big = tuple(
        tuple(v + (10**30 if i == j else 0) for j, v in enumerate(row))
        for i, row in enumerate(first)
    )
    forged = replace(EVIDENCE, vanishing=(big, *rest))
    assert forged.find_fault(SYSTEM) == "a form that must vanish does not"


@pytest.mark.parametrize("change", [lambda v: v[:-1], lambda v: (*v, v[-1]), lambda v: ()])
def test_a_form_for_each_decrease(change):
    forged = replace(EVIDENCE, vanishing=change(EVIDENCE.vanishing))
    assert forged.find_fault(SYSTEM) == "there is not one vanishing form for each decrease"


@pytest.mark.parametrize("degree", [0, -1, 33, 10**9])
def test_degrees_out_of_range(degree):
    assert "is not between 2 and 64" in replace(EVIDENCE, degree=degree).find_fault(SYSTEM)


@pytest.mark.parametrize("rate", [Fraction(0), Fraction(1), Fraction(2), Fraction(95, 100)])
def test_rates_that_are_not_proved(rate):
    """The growth along the published cycle is 0.97482."""
    quadratic = replace(EVIDENCE.quadratic, rate=rate)
    assert replace(EVIDENCE, quadratic=quadratic).find_fault(SYSTEM) is not None


def test_one_more_switch_is_not_covered():
    switching = SYSTEM.switching
    more = replace(switching, transitions=(*switching.transitions, ("n4", "n1")))
    assert EVIDENCE.find_fault(replace(SYSTEM, switching=more)) is not None


@pytest.mark.parametrize("longest", [2, 3, None])
def test_a_longer_stay_is_not_covered(longest):
    """Without a bound the mode is not one that must be left."""
    stays = dict(SYSTEM.switching.stays)
    stays["n1"] = Stay(Fraction(1), None if longest is None else Fraction(longest))
    longer = replace(SYSTEM.switching, stays=tuple(stays.items()))
    assert EVIDENCE.find_fault(replace(SYSTEM, switching=longer)) is not None


def test_another_matrix_is_not_covered():
    modes = list(SYSTEM.modes)
    modes[0], modes[2] = replace(modes[0], A=modes[2].A), replace(modes[2], A=modes[0].A)
    assert EVIDENCE.find_fault(replace(SYSTEM, modes=tuple(modes))) is not None


def test_not_for_continuous_time():
    continuous = replace(SYSTEM, time=Time.CONTINUOUS)
    assert EVIDENCE.find_fault(continuous) == "polynomials for each mode are for discrete time"
    assert "mode polynomial" not in str(certify(geromel_colaneri("2.7")).attempts)


def test_numbers_that_are_too_large_are_not_lifted():
    huge = family(
        [[Fraction(1, 10**5000)] * 20] * 20,
        [[Fraction(1, 10**4999)] * 20] * 20,
        time=Time.DISCRETE,
        names=("n1", "n2"),
    )
    evidence = replace(EVIDENCE, degree=1)
    assert evidence.find_fault(huge) == "the numbers are too large to lift"
    assert "more than 120 monomials" in replace(EVIDENCE, degree=3).find_fault(huge)


def test_stays_that_are_too_long():
    stays = (("n1", Stay(Fraction(1), Fraction(MAX_DWELL_STEPS + 1))),)
    long = replace(SYSTEM, switching=replace(SYSTEM.switching, stays=stays))
    quadratic = replace(EVIDENCE.quadratic, leaving=("n1",))
    assert replace(EVIDENCE, quadratic=quadratic).find_fault(long) == "the dwell time is too long"


def test_degree_one_is_a_quadratic_function_for_each_mode():
    rates = family([["1/2"]], [["1/4"]], time=Time.DISCRETE, switching=Switching(Fraction(2)))
    quadratic = ModeQuadratic((("m0", ((1,),)), ("m1", ((1,),))), 0, Fraction(3, 4))
    assert quadratic.find_fault(rates) is None
    zero = ((0,),)
    assert ModePolynomial(1, quadratic, (zero,) * 4).find_fault(rates) is None


def test_resets_are_lifted_too_between_modes_of_different_sizes():
    """Each mode contracts; the resets undo less than a step gains."""
    resets = resets_between(("m0", "m1", [["3/2", "1/2"]]), ("m1", "m0", [["1"], ["1/3"]]))
    system = family(
        [["1/2", "1/4"], [0, "1/2"]],
        [["1/2"]],
        time=Time.DISCRETE,
        switching=Switching(resets=resets),
    )
    found = certify(system, Method.MODE_POLYNOMIAL, Limits(max_degree=4))
    assert found.verdict == "proved"
    lifted = lift_system(system, 2)
    assert [mode.A.shape for mode in lifted.modes] == [(3, 3), (1, 1)]
    # (3/2 x + 1/2 y)^2, and the squares of (1, 1/3).
    assert lifted.switching.resets[0].map.fractions() == [
        [Fraction(9, 4), Fraction(3, 2), Fraction(1, 4)]
    ]
    assert [row[0] for row in lifted.switching.resets[1].map.fractions()] == [
        1,
        Fraction(1, 3),
        Fraction(1, 9),
    ]
    grown = resets_between(("m0", "m1", [["8", "1/2"]]), ("m1", "m0", [["1"], ["1/3"]]))
    worse = replace(system, switching=Switching(resets=grown))
    assert found.evidence.find_fault(worse) is not None


def test_the_modes_that_must_be_left_are_those_of_its_functions():
    _, evidence = genuine("mode-polynomial")
    assert evidence.leaving == evidence.quadratic.leaving
    left = replace(evidence, quadratic=replace(evidence.quadratic, leaving=("m0",)))
    assert left.leaving == ("m0",)
