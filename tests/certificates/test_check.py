"""Evidence against systems: what must be accepted, and everything that must not."""

from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nrs_design.certificates.certificate import CommonQuadratic, UnstableMode
from nrs_design.certificates.check import decrease, find_fault, is_stable
from nrs_design.switched.matrix import RationalMatrix
from nrs_design.switched.system import Mode, SwitchedSystem, Time
from tests.support import dayawansa_martin, family, holds, is_definite_by_ldl, matrix

# Narendra and Balakrishnan 1994: x1^2 + x2^2 works for normal stable matrices.
COMMUTING = family([[-1, 1], [-1, -1]], [[-2, 3], [-3, -2]])
IDENTITY = ((1, 0), (0, 1))
HALF = CommonQuadratic(IDENTITY, 0, Fraction(1, 2))


def fault(system, Q, rate):
    return find_fault(system, CommonQuadratic(Q, 0, Fraction(rate)))


def test_commuting_modes_hold_up_to_the_slowest_rate():
    assert find_fault(COMMUTING, HALF) is None
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
    assert (find_fault(system, evidence) is None) == holds(system, evidence)


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
    assert fault(COMMUTING, Q, "1/2") == "Q is not a symmetric 2 x 2 matrix"


@pytest.mark.parametrize(
    "Q", [((0, 0), (0, 0)), ((1, 1), (1, 1)), ((-1, 0), (0, -1)), ((1, 0), (0, 0))]
)
def test_not_definite(Q):
    assert fault(COMMUTING, Q, "1/2") == "Q is not positive definite"


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
        assert f"mode m{bad}" in find_fault(family(*matrices), HALF)


def test_no_modes_prove_nothing():
    empty = SwitchedSystem("empty", Time.CONTINUOUS, ("x1", "x2"), (), ())
    assert find_fault(empty, HALF) == "the system has no modes"
    assert find_fault(empty, UnstableMode("m0", "1")) is not None


def test_malformed_modes():
    ragged = replace(COMMUTING, modes=(Mode("odd", matrix([[-1, 0, 0], [0, -1, 0]])),))
    assert "mode odd is not an 2 x 2" in find_fault(ragged, HALF)
    # Over a denominator of the wrong sign, numerators of a stable matrix are an unstable one.
    for denominator in (0, -1):
        turned = Mode("turned", RationalMatrix(((-1, 0), (0, -1)), denominator))
        assert "mode turned" in find_fault(replace(COMMUTING, modes=(turned,)), HALF)


@pytest.mark.parametrize(
    ("A", "time", "stable"),
    [
        ([["-0.36", "-0.48"], ["-0.48", "-0.64"]], Time.CONTINUOUS, False),
        ([[0, 1], [-1, 0]], Time.CONTINUOUS, False),
        ([[-1, 0], [0, -1]], Time.CONTINUOUS, True),
        ([[-1, 0], [0, -1]], Time.DISCRETE, False),
        ([["-1/2", 0], [0, "1/2"]], Time.DISCRETE, True),
        ([["-1/2", 0], [0, "1/2"]], Time.CONTINUOUS, False),
        ([["0.6", "0.8"], ["-0.8", "0.6"]], Time.DISCRETE, False),
    ],
)
def test_unstable_mode(A, time, stable):
    system = family([[0, 0], [0, 0]], A, time=time)
    assert is_stable(system.modes[1], time) is stable
    found = find_fault(system, UnstableMode("m1", "never looked at"))
    assert (found is None) is not stable


def test_unknown_and_ambiguous_modes_refute_nothing():
    system = family([[1, 0], [0, 1]])
    assert find_fault(system, UnstableMode("m0", "1")) is None
    assert "no single mode" in find_fault(system, UnstableMode("m1", "1"))
    twice = replace(system, modes=system.modes * 2)
    assert "no single mode" in find_fault(twice, UnstableMode("m0", "1"))


def test_scale_of_evidence_does_not_matter():
    for factor in (1, 3, 10**200):
        scaled = CommonQuadratic(((factor, 0), (0, factor)), 7, Fraction(1, 2))
        assert find_fault(COMMUTING, scaled) is None
        mode = COMMUTING.modes[0]
        assert is_definite_by_ldl(decrease(mode, scaled, Time.CONTINUOUS))
