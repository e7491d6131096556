"""Balls contain what they stand for, and the integers made from them are below it."""

from fractions import Fraction
from time import process_time

import numpy as np
import pytest
from flint import acb, arb, arb_mat, ctx, fmpq
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import expm

from nrs_design.proof.enclosure import balls, eigenvalues, exponential, lower_integers, precision
from nrs_design.proof.exact import is_positive_definite
from nrs_design.proof.matrix import RationalMatrix


def lower(rows):
    return lower_integers(arb_mat(rows))


@given(
    st.lists(st.floats(-1, 1), min_size=3, max_size=3),
    st.floats(0, 1e-3),
    st.integers(-200, 200),
)
def test_rounded_balls_stay_below_every_matrix_in_them(entries, radius, exponent):
    """If the rounded matrix is definite, so are all corners of the ball matrix."""
    a, b, c = entries
    mids = np.array([[1 + abs(a), b], [b, 1 + abs(c)]])
    scale = arb(2) ** exponent
    enclosed = arb_mat([[arb(float(m), radius) * scale for m in row] for row in mids])
    corners = [
        mids + radius * np.array([[s, t], [t, u]])
        for s in (-1, 1)
        for t in (-1, 1)
        for u in (-1, 1)
    ]
    smallest = min(np.linalg.eigvalsh(corner).min() for corner in corners)
    if is_positive_definite(lower_integers(enclosed)):
        assert smallest > -1e-12
    else:
        assert smallest < 4 * radius + 1e-12


@given(
    st.lists(st.floats(-1, 1), min_size=3, max_size=3),
    st.floats(0, 1e-3),
    st.integers(-60, 60),
)
def test_states_in_other_units_cost_nothing(entries, radius, log2):
    """What is below a form is below it in other units, and is found there as well."""
    a, b, c = entries
    mids = [[1 + abs(a), b], [b, 1 + abs(c)]]
    unit = [arb(1), arb(2) ** log2]
    corners = [
        [
            [mids[0][0] - radius, mids[0][1] + s * radius],
            [mids[1][0] + s * radius, mids[1][1] - radius],
        ]
        for s in (-1, 1)
    ]
    smallest = min(np.linalg.eigvalsh(np.array(corner)).min() for corner in corners)
    enclosed = [
        [arb(m, radius) * u * v for m, v in zip(row, unit, strict=True)]
        for row, u in zip(mids, unit, strict=True)
    ]
    if is_positive_definite(lower(enclosed)):
        assert smallest > -1e-12
    else:
        assert smallest < 8 * radius + 1e-12


@pytest.mark.parametrize(
    "ball", [arb("nan"), arb("inf"), arb(1, float("inf")), arb(2) ** (10**15), arb(0, 2)]
)
def test_balls_that_say_nothing_prove_nothing(ball):
    start = process_time()
    assert not is_positive_definite(lower([[ball, arb(0)], [arb(0), arb(1)]]))
    assert not is_positive_definite(lower([[arb(1), ball], [ball, arb(1)]]))
    assert process_time() - start < 1


def test_tiny_balls_count_as_their_bound_and_not_as_nothing():
    tiny = arb(2) ** -(10**15)
    # [[0, t], [t, 1]] is not definite for any t > 0, however tiny.
    assert not is_positive_definite(lower([[arb(0), tiny], [tiny, arb(1)]]))
    assert not is_positive_definite(lower([[tiny, arb(0)], [arb(0), tiny]]))
    assert is_positive_definite(lower([[arb(1), tiny], [tiny, arb(1)]]))


def test_the_enclosure_is_not_a_point():
    with precision(64):
        E = exponential(RationalMatrix(((1, 2), (3, 4))), Fraction(1), Fraction(1))
    assert not E[0, 0].is_exact()


def test_the_precision_is_set_back_after_an_error():
    before = ctx.prec
    with pytest.raises(ZeroDivisionError), precision(77):
        balls(RationalMatrix(((1,),), 0))
    assert ctx.prec == before


@given(st.lists(st.integers(-9, 9), min_size=4, max_size=4), st.integers(0, 9), st.integers(0, 9))
def test_exponentials_against_pade(entries, begin, width):
    """Those of SciPy (Al-Mohy and Higham 2009), at both ends and in the middle of the times."""
    A = RationalMatrix((tuple(entries[:2]), tuple(entries[2:])), 10)
    first, last = Fraction(begin, 10), Fraction(begin + width, 10)
    with precision():
        E = exponential(A, first, last)
        for t in (first, (first + last) / 2, last):
            known = expm(np.array(A.floats()) * float(t))
            for i in range(2):
                for j in range(2):
                    assert arb(known[i, j], 1e-11 * np.abs(known).max()).overlaps(E[i, j])


@given(st.lists(st.integers(-9, 9), min_size=9, max_size=9), st.integers(1, 9))
def test_eigenvalues_add_up_to_the_trace_as_often_as_they_occur(entries, denominator):
    A = RationalMatrix(tuple(tuple(entries[k : k + 3]) for k in (0, 3, 6)), denominator)
    found = eigenvalues(A)
    assert len(found) == 3
    assert sum(found, start=acb(0)).overlaps(acb(fmpq(sum(entries[::4]), denominator)))


def test_multiple_eigenvalues():
    assert len(eigenvalues(RationalMatrix(((1, 0), (0, 1)), 2))) == 2
