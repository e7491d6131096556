"""Common quadratic functions: which roundings are proposed, and in which order."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from nrs_design.search.common_quadratic import CommonQuadratic, search_by_lmi

from nrs_design.proof.evidence.fields import MAX_INTEGER_BITS
from nrs_design.search.family import Family, floats_in_silence
from nrs_design.search.rounding import digits
from tests.support import dayawansa_martin, family, holds

LEVEL = np.zeros(2, dtype=np.int64)
SYSTEM = dayawansa_martin(5)
GOOD = np.diag([1.0, 5.0])


def rounded(system, Q, claim=Fraction(1, 1000), exponents=LEVEL):
    """The first rounding near Q, in coordinates scaled by 2^d, that passes the exact check."""
    matrices = np.array([mode.A.floats() for mode in system.modes])
    with floats_in_silence():
        scaled = np.ldexp(matrices, exponents[None, :] - exponents[:, None])
        family_ = replace(Family.of(system), matrices=scaled, exponents=exponents)
        proposed = CommonQuadratic(family_).roundings(Q, claim, digits())
        return next((e for e in proposed if e.find_fault(system) is None), None)


def test_fast_ones_are_proposed_first_and_the_sure_one_at_last():
    proposed = list(search_by_lmi(Family.of(SYSTEM)))
    words = [candidate.words for candidate in proposed]
    fast = words.count("found with the largest decay rate")
    assert words == ["found with the largest decay rate"] * fast + ["found"] * (len(words) - fast)
    for part in (proposed[:fast], proposed[fast:]):
        rates = [candidate.evidence.rate for candidate in part]
        assert rates == sorted(rates, reverse=True)
    plain = list(search_by_lmi(Family.of(SYSTEM, optimize_rate=False)))
    assert [candidate.evidence for candidate in plain] == [c.evidence for c in proposed[fast:]]


def test_few_bits_are_enough_for_a_good_candidate():
    evidence = rounded(SYSTEM, GOOD)
    form = evidence.nodes[0].form
    assert form == ((3, 0), (0, 10)) or form[0][0] < 16
    assert holds(SYSTEM, evidence)


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
        assert rounded(SYSTEM, Q) is None


@pytest.mark.parametrize("factor", [1.5e308 / 5, 5e-324])
def test_candidates_at_the_ends_of_the_range(factor):
    evidence = rounded(SYSTEM, GOOD * factor)
    assert evidence is not None
    assert holds(SYSTEM, evidence)


def test_integers_too_long_for_a_file_are_not_evidence():
    """A certificate is JSON, of which Python reads integers of at most 4300 digits."""
    still = family([[-1, 0], [0, -1]])
    near, far = np.array([0, MAX_INTEGER_BITS // 2 - 100]), np.array([0, MAX_INTEGER_BITS])
    assert rounded(still, np.eye(2), Fraction(1, 2), near) is not None
    assert rounded(still, np.eye(2), Fraction(1, 2), far) is None
    assert len(str(2**MAX_INTEGER_BITS)) < 4300
