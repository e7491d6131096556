from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from nrs_design.search.checker import Checker

from nrs_design.proof.evidence.fields import MAX_INTEGER_BITS
from nrs_design.proof.system import Time
from nrs_design.search.rounding import (
    RATE_BITS,
    round_rate,
    round_to_evidence,
)
from tests.support import dayawansa_martin, family, holds

LEVEL = np.zeros(2, dtype=np.int64)
SYSTEM = dayawansa_martin(5)
GOOD = np.diag([1.0, 5.0])


@given(st.floats(1e-300, 1e300))
def test_rates_in_continuous_time_only_get_slower(rate):
    rounded = round_rate(rate, Time.CONTINUOUS)
    assert 0 < rounded <= Fraction(rate)
    assert rounded >= Fraction(rate) * (1 - Fraction(1, 2 ** (RATE_BITS - 1)))
    assert rounded.denominator & (rounded.denominator - 1) == 0


@given(st.floats(0, 1, exclude_max=True))
def test_rates_in_discrete_time_only_get_slower(rate):
    assert Fraction(rate) <= round_rate(rate, Time.DISCRETE) < 1


def test_few_bits_are_enough_for_a_good_candidate():
    evidence = round_to_evidence(Checker(SYSTEM), GOOD, LEVEL, Fraction(1, 1000))
    assert evidence.Q == ((3, 0), (0, 10)) or evidence.Q[0][0] < 16
    assert holds(SYSTEM, evidence)


def test_denominator_gives_back_the_candidate():
    evidence = round_to_evidence(Checker(SYSTEM), GOOD * 1e200, LEVEL, Fraction(1, 1000))
    Q = np.array(evidence.Q, dtype=float)
    np.testing.assert_allclose(Q[0, 0] / Q[1, 1], 0.2, rtol=0.2)
    assert evidence.denominator_log2 >= 0


@pytest.mark.parametrize("exponents", [(0, 3), (5, -5), (-40, 17)])
def test_scaling_is_undone_exactly(exponents):
    """In scaled coordinates the modes are 2^-d A 2^d; the evidence is for A itself."""
    d = np.array(exponents)
    powers = [Fraction(2) ** e for e in exponents]
    stretched = family(
        *(
            [
                [powers[i] * e / powers[j] for j, e in enumerate(row)]
                for i, row in enumerate(m.A.fractions())
            ]
            for m in SYSTEM.modes
        )
    )
    evidence = round_to_evidence(Checker(stretched), GOOD, d, Fraction(1, 1000))
    assert evidence is not None
    assert holds(stretched, evidence)


@pytest.mark.parametrize(
    "Q",
    [
        np.zeros((2, 2)),
        np.full((2, 2), np.nan),
        np.diag([np.inf, 1.0]),
        -GOOD,
        np.diag([1.0, -1.0]),
        np.eye(2),
    ],
)
def test_bad_candidates_are_not_evidence(Q):
    with np.errstate(all="ignore"):
        assert round_to_evidence(Checker(SYSTEM), Q, LEVEL, Fraction(1, 1000)) is None


@pytest.mark.parametrize("factor", [1.5e308 / 5, 5e-324])
def test_candidates_at_the_ends_of_the_range(factor):
    evidence = round_to_evidence(
        Checker(SYSTEM), np.diag([1.0, 5.0]) * factor, LEVEL, Fraction(1, 1000)
    )
    assert evidence is not None
    assert holds(SYSTEM, evidence)


@given(st.integers(20, 1900))
def test_rates_beyond_floating_point(digits):
    tiny = Fraction(1, 10**digits)
    rounded = round_rate(tiny, Time.CONTINUOUS)
    assert tiny * (1 - Fraction(1, 2 ** (RATE_BITS - 1))) <= rounded <= tiny
    assert round_rate(1 - tiny, Time.DISCRETE) == 1 - rounded


def test_integers_too_long_for_a_file_are_not_evidence():
    """A certificate is JSON, of which Python reads integers of at most 4300 digits."""
    still = family([[-1, 0], [0, -1]])
    near, far = np.array([0, MAX_INTEGER_BITS // 2 - 100]), np.array([0, MAX_INTEGER_BITS])
    assert round_to_evidence(Checker(still), np.eye(2), near, Fraction(1, 2)) is not None
    assert round_to_evidence(Checker(still), np.eye(2), far, Fraction(1, 2)) is None
    assert len(str(2**MAX_INTEGER_BITS)) < 4300
