"""Polynomials for each mode: what is accepted, and what must not be."""

from dataclasses import replace
from fractions import Fraction

import pytest

from nrs_design.proof.evidence import ModePolynomial, ModeQuadratic
from nrs_design.proof.evidence.mode_polynomial import find_large_lift, lift_system
from nrs_design.proof.evidence.mode_quadratic import MAX_DWELL_STEPS
from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Stay, Switching
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


def test_the_claim_has_the_rate():
    quadratic = replace(EVIDENCE.quadratic, rate=Fraction(49, 50))
    claim = replace(EVIDENCE, quadratic=quadratic).claim(SYSTEM)
    assert "rho^t |x(0)|" in claim
    assert "rho = 0.98" in claim


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


def scalars(degree, rate="3/4", **fields):
    """``5 x^(2 d)`` and ``7 x^(2 d)`` for two modes of one state."""
    quadratic = ModeQuadratic((("m0", ((5,),)), ("m1", ((7,),))), 0, Fraction(rate), **fields)
    return ModePolynomial(degree, quadratic, (((0,),),) * 4)


HALVES = family([["1/2"]], [["-1/2"]], time=Time.DISCRETE)


@pytest.mark.parametrize(("degree", "fits"), [(0, False), (1, True), (32, True), (33, False)])
def test_degrees(degree, fits):
    fault = None if fits else f"degree {2 * degree} is not between 2 and 64"
    assert scalars(degree).find_fault(HALVES) == fault


def test_forms_of_one_state_by_hand():
    """Of degree six, at the rate 3/4: in a mode, and from one to the other."""
    *functions, first, second, there, back = (form for _, form in scalars(3).forms(HALVES))
    assert functions == [((5,),), ((7,),)]
    rate, factor = Fraction(3, 4) ** 6, Fraction(1, 64)
    clear = (8 * 64) ** 2
    assert first == [[clear * 5 * (rate - factor)]]
    assert second == [[clear * 7 * (rate - factor)]]
    assert there == [[clear * (5 * rate - 7 * factor)]]
    assert back == [[clear * (7 * rate - 5 * factor)]]


@pytest.mark.parametrize(("n", "fits"), [(120, True), (121, False)])
def test_the_most_monomials(n, fits):
    large = family([[int(i == j) for j in range(n)] for i in range(n)], [[1]], time=Time.DISCRETE)
    fault = None if fits else "there are more than 120 monomials of degree 1"
    assert find_large_lift(large, 1) == fault
    turned = replace(large, modes=large.modes[::-1])
    assert find_large_lift(turned, 1) == fault


@pytest.mark.parametrize(
    "system",
    [
        family([[7]], [[1]], time=Time.DISCRETE),
        family([["1/5"]], [[1]], time=Time.DISCRETE),
        family([[1]], [[-7]], time=Time.DISCRETE),
        family([[1]], [[1]], time=Time.DISCRETE, switching=Switching(
            resets=resets_between(("m0", "m1", [[5]])))),
        family([[1]], [[1]], time=Time.DISCRETE, switching=Switching(
            resets=resets_between(("m0", "m1", [["1/7"]])))),
    ],
)  # fmt: skip
def test_the_longest_numbers_that_are_lifted(monkeypatch, system):
    limit = "nrs_design.proof.evidence.mode_polynomial.MAX_WORK"
    monkeypatch.setattr(limit, 2 * 3)
    assert find_large_lift(system, 2) is None
    monkeypatch.setattr(limit, 2 * 3 - 1)
    assert find_large_lift(system, 2) == "the numbers are too large to lift"


def test_the_work_of_a_lift_grows_with_the_monomials(monkeypatch):
    system = family([[1, 0], [0, 1]], time=Time.DISCRETE)
    monkeypatch.setattr("nrs_design.proof.evidence.mode_polynomial.MAX_WORK", 4**3 * 3)
    assert find_large_lift(system, 3) is None
    monkeypatch.setattr("nrs_design.proof.evidence.mode_polynomial.MAX_WORK", 4**3 * 3 - 1)
    assert find_large_lift(system, 3) == "the numbers are too large to lift"


def test_every_form_fits_the_mode_in_which_its_decrease_begins():
    assert len({len(N) for N in EVIDENCE.vanishing}) == 1
    for k, N in enumerate(EVIDENCE.vanishing):
        forms = list(EVIDENCE.vanishing)
        forms[k] = N[:-1]
        fault = replace(EVIDENCE, vanishing=tuple(forms)).find_fault(SYSTEM)
        assert "a form that must vanish has the wrong size for mode" in fault
        forms[k] = dict(EVIDENCE.quadratic.functions)["n1"]
        fault = replace(EVIDENCE, vanishing=tuple(forms)).find_fault(SYSTEM)
        assert fault == "a form that must vanish does not"


def test_lifted_states_are_those_of_the_largest_mode():
    resets = resets_between(("m0", "m1", [[1, 0]]), ("m1", "m0", [[1], [0]]))
    system = family(
        [["1/2", 0], [0, "1/3"]], [["1/2"]], time=Time.DISCRETE, switching=Switching(resets=resets)
    )
    lifted = lift_system(system, 3)
    assert lifted.states == ("z1", "z2", "z3", "z4")
    assert lifted.modes[0].A.fractions() == [
        [Fraction(int(i == j), 2 ** (3 - i) * 3**i) for j in range(4)] for i in range(4)
    ]
    assert lifted.modes[1].A.fractions() == [[Fraction(1, 8)]]


def test_the_degree_in_a_file():
    fields = scalars(3).to_fields()
    assert fields["degree"] == 6
    assert ModePolynomial.from_fields(fields, HALVES) == scalars(3)
    with pytest.raises(ValueError, match="odd"):
        ModePolynomial.from_fields({**fields, "degree": 7}, HALVES)


def test_the_rate_is_one_of_decay():
    for rate in ("0", "1", "-1/2"):
        fault = scalars(2, rate).find_fault(HALVES)
        assert fault == "the claimed rate is not one of exponential decay"
    assert scalars(2, "2/3").proved_rate(HALVES) == Fraction(2, 3)


def test_the_ends_of_a_constant_parameter_are_not_covered():
    ends = replace(HALVES, switching=Switching(fixed_ends=(("m0", "m1"),)))
    assert scalars(2).find_fault(HALVES) is None
    assert "does not cover this kind of switching" in scalars(2).find_fault(ends)
