"""One quadratic function for all modes: what must be accepted, and everything that must not."""

from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nrs_design.proof.channels import Rounding
from nrs_design.proof.evidence import CommonQuadratic, Shows
from nrs_design.proof.evidence.growing_sequence import staying
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.steps import Steps
from nrs_design.proof.switching import Reset, Switching
from nrs_design.proof.system import SwitchedSystem
from tests.proof.systems import bouncing_in_steps, genuine
from tests.support import dayawansa_martin, family, holds, is_definite_by_ldl, matrix

# Narendra and Balakrishnan 1994: x1^2 + x2^2 works for normal stable matrices.
COMMUTING = family([[-1, 1], [-1, -1]], [[-2, 3], [-3, -2]])
IDENTITY = ((1, 0), (0, 1))
HALF = CommonQuadratic(IDENTITY, 0, Fraction(1, 2))


def fault(system, Q, rate):
    return CommonQuadratic(Q, 0, Fraction(rate)).find_fault(system)


def test_commuting_modes_hold_up_to_the_slowest_rate():
    assert HALF.find_fault(COMMUTING) is None
    assert fault(COMMUTING, IDENTITY, "999999999999999999999/1000000000000000000000") is None
    assert "mode m0" in fault(COMMUTING, IDENTITY, 1)
    assert "mode m0" in fault(COMMUTING, IDENTITY, 2)


def test_known_function_of_dayawansa_martin():
    # x1^2 + b x2^2 works for a = 5 iff 4.29 < b < 5.83; the identity does not.
    assert fault(dayawansa_martin(5), ((1, 0), (0, 5)), "1/1000") is None
    assert "mode m1" in fault(dayawansa_martin(5), IDENTITY, "1/1000")


@settings(deadline=None)
@given(st.integers(1, 60), st.integers(-60, 60), st.integers(1, 60), st.fractions(5.83, 50))
def test_no_quadratic_function_beyond_the_threshold(p, q, r, a):
    """Dayawansa and Martin 1999: none exists for a >= 3 + 2 sqrt(2), so nothing may pass."""
    assert fault(dayawansa_martin(a), ((p, q), (q, r)), "1/1000000") is not None


@settings(deadline=None)
@given(
    st.lists(st.lists(st.integers(-5, 5), min_size=4, max_size=4), min_size=1, max_size=3),
    st.lists(st.integers(-5, 5), min_size=3, max_size=3),
    st.fractions("1/10", 3),
    st.sampled_from(list(Time)),
)
def test_against_the_definition(modes, entries, rate, time):
    """The definition in fractions, decided by another elimination."""
    matrices = [[row[:2], row[2:]] for row in modes]
    system = family(*([[Fraction(e, 6) for e in r] for r in A] for A in matrices), time=time)
    p, q, r = entries
    evidence = CommonQuadratic(((p, q), (q, r)), 0, rate)
    assert (evidence.find_fault(system) is None) == holds(system, evidence)


@pytest.mark.parametrize(
    "Q",
    [
        (),
        ((1,),),
        ((1, 0),),
        ((1, 0), (0,)),
        ((1, 0), (0, 1), (0, 0)),
        ((1, 0, 0), (0, 1, 0)),
        ((1, 1), (0, 1)),
        ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    ],
)
def test_wrong_shape_or_symmetry(Q):
    words = fault(COMMUTING, Q, "1/2")
    assert words in ("Q is not a 2 x 2 matrix", "Q is not symmetric and positive definite")


@pytest.mark.parametrize(
    "Q", [((0, 0), (0, 0)), ((1, 1), (1, 1)), ((-1, 0), (0, -1)), ((1, 0), (0, 0))]
)
def test_not_definite(Q):
    assert fault(COMMUTING, Q, "1/2") == "Q is not symmetric and positive definite"


@pytest.mark.parametrize("rate", [0, -1, "-1/1000000"])
def test_not_a_rate_of_decay(rate):
    assert "not one of exponential decay" in fault(COMMUTING, IDENTITY, rate)


@pytest.mark.parametrize("rate", [0, -1, 1, 2, "-1/2"])
def test_not_a_contraction(rate):
    still = family([[0, 0], [0, 0]], time=Time.DISCRETE)
    assert "not one of exponential decay" in fault(still, IDENTITY, rate)


def test_negative_contraction_is_not_taken_for_its_square():
    system = family([["1/4", 0], [0, "1/4"]], time=Time.DISCRETE)
    assert fault(system, IDENTITY, "1/2") is None
    assert fault(system, IDENTITY, "-1/2") is not None


def test_every_mode_counts():
    for bad in range(3):
        matrices = [[[-1, 0], [0, -1]]] * 3
        matrices[bad] = [[1, 0], [0, -1]]
        assert f"mode m{bad}" in HALF.find_fault(family(*matrices))


def test_no_modes_prove_nothing():
    empty = SwitchedSystem("empty", Time.CONTINUOUS, ("x1", "x2"), (), ())
    assert HALF.find_fault(empty) == "the system has no modes"
    assert staying("m0").find_fault(empty) is not None


def test_malformed_modes():
    ragged = replace(COMMUTING, modes=(Mode("odd", matrix([[-1, 0, 0], [0, -1, 0]])),))
    assert "mode odd is not a square matrix" in HALF.find_fault(ragged)
    # Over a denominator of the wrong sign, numerators of a stable matrix are an unstable one.
    for denominator in (0, -1):
        turned = Mode("turned", RationalMatrix(((-1, 0), (0, -1)), denominator))
        assert "mode turned" in HALF.find_fault(replace(COMMUTING, modes=(turned,)))


def test_scale_of_evidence_does_not_matter():
    for factor in (1, 3, 10**200):
        scaled = CommonQuadratic(((factor, 0), (0, factor)), 7, Fraction(1, 2))
        assert scaled.find_fault(COMMUTING) is None
        assert all(is_definite_by_ldl(form) for _, form in scaled.forms(COMMUTING))


def test_forms_are_q_and_one_for_each_mode():
    words = [failure for failure, _ in HALF.forms(COMMUTING)]
    assert len(words) == 3
    assert "Q is not" in words[0]
    assert words[1].endswith("mode m0")
    assert words[2].endswith("mode m1")


def test_two_modes_of_one_name_prove_nothing():
    """Names stand for modes in certificates, so that they must tell them apart."""
    twice = replace(COMMUTING, modes=COMMUTING.modes[:1] * 2)
    assert "same name" in HALF.find_fault(twice)


@pytest.mark.parametrize(
    "switching",
    [
        Switching(dwell_time=Fraction(1)),
        Switching(transitions=(("m0", "m1"),)),
        Switching(fixed_ends=(("m0", "m1"),)),
    ],
)
def test_what_holds_for_all_signals_holds_for_fewer(switching):
    assert HALF.find_fault(replace(COMMUTING, switching=switching)) is None


def test_resets_are_not_covered():
    doubling = Reset("m0", "m1", matrix([[2, 0], [0, 2]]))
    system = replace(COMMUTING, switching=Switching(resets=(doubling,)))
    assert "does not cover this kind of switching" in HALF.find_fault(system)


def test_numbers_too_large_to_check_prove_nothing():
    huge = 1 << 20_000_000
    assert "more than 14000 are not read" in fault(COMMUTING, ((huge, 0), (0, huge)), "1/2")


def test_words_and_fields():
    assert HALF.shows is Shows.STABILITY
    assert HALF.proved_rate(COMMUTING) == Fraction(1, 2)
    assert HALF.claim(COMMUTING) == (
        "Every solution of x' = A x, switching arbitrarily among the 2 modes, satisfies "
        "|x(t)| <= exp(-alpha t) |x(0)| with alpha = 0.5 1/s, in the norm "
        "|x| = sqrt(x' Q x)."
    )
    fields = HALF.to_fields()
    assert fields == {"Q": {"numerators": [[1, 0], [0, 1]], "denominator_log2": 0}, "rate": "1/2"}
    assert CommonQuadratic.from_fields(fields, COMMUTING) == HALF


@pytest.mark.parametrize(
    "fields",
    [
        {},
        {"rate": "1/2"},
        {"Q": {"numerators": [[1]], "denominator_log2": 0}},
        {"Q": {"numerators": [[1.0]], "denominator_log2": 0}, "rate": "1/2"},
        {"Q": {"numerators": [[True]], "denominator_log2": 0}, "rate": "1/2"},
        {"Q": {"numerators": [["1"]], "denominator_log2": 0}, "rate": "1/2"},
        {"Q": {"numerators": 1, "denominator_log2": 0}, "rate": "1/2"},
        {"Q": {"numerators": [[1]], "denominator_log2": -1}, "rate": "1/2"},
        {"Q": {"numerators": [[1]], "denominator_log2": 0}, "rate": 1},
        {"Q": {"numerators": [[1]], "denominator_log2": 0}, "rate": "-1/2"},
        {"Q": {"numerators": [[1]], "denominator_log2": 0}, "rate": "1/0"},
    ],
)
def test_malformed_fields(fields):
    with pytest.raises((KeyError, TypeError, ValueError, ZeroDivisionError)):
        CommonQuadratic.from_fields(fields, COMMUTING)


def test_what_a_common_quadratic_function_carries_over_to():
    """One convex function: averages of modes, bounds from the first moment on."""
    _, evidence = genuine("common-quadratic")
    assert evidence.is_common_quadratic
    assert evidence.keeps_bound_in_mixtures
    assert evidence.covers_mixtures
    assert evidence.bounds_at_once


@pytest.mark.parametrize(("modes", "words"), [(1, "its one mode"), (2, "the 2 modes")])
def test_a_claim_counts_the_modes(modes, words):
    evidence = CommonQuadratic(((1,),), 0, Fraction(1, 2))
    assert words in evidence.claim(family(*[[[-1]]] * modes))


def test_with_rounding_its_forms_are_those_of_a_step_in_kept_contact():
    system = bouncing_in_steps()
    count = len(system.modes) + len(system.contact.free)
    error = Rounding("F", (matrix([[1], ["1/2"]]),) * count, (matrix([["1/9", 0]]),) * count)
    rounded = replace(system, roundings=(error,))
    exact = CommonQuadratic(((40, 20), (20, 60)), 3, Fraction(99, 100))
    covered = replace(exact, roundings=(7,))
    assert (exact.covers_rounding, covered.covers_rounding) == (False, True)
    (_, Q), *forms = covered.forms(rounded)
    assert Q == exact.Q
    steps = Steps(exact.Q, 3, Fraction(99, 100) ** 2, roundings=(7,))
    kept = steps.forms(replace(rounded, contact=None))
    words = "V does not decrease at the claimed rate"
    assert forms == [(f"{words} {where}", form) for where, form in kept]
    assert list(exact.forms(rounded)) == list(exact.forms(system))
    assert [failure for failure, _ in exact.forms(system)][1:] == [
        f"{words} in mode m0",
        f"{words} in mode m1",
    ]
    assert CommonQuadratic.from_fields(covered.to_fields(), rounded) == covered
    assert CommonQuadratic.from_fields(exact.to_fields(), rounded) == exact
    assert "one multiplier for each rounding" in covered.find_misfit(system)
