"""Balls contain what they stand for, and the integers made from them are below it."""

from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from flint import acb, arb, arb_mat, ctx, fmpq
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import expm

from nrs_design.proof import enclosure
from nrs_design.proof.exact import is_positive_definite
from nrs_design.proof.matrix import RationalMatrix
from tests.support import ends_soon
from tests.tables import by_rows


def lower(rows):
    return enclosure.lower_integers(arb_mat(rows))


@given(
    st.lists(st.floats(-1, 1), min_size=3, max_size=3),
    st.floats(0, 1e-3),
    st.integers(-200, 200),
    st.integers(-60, 60),
)
def test_rounded_balls_stay_below_every_matrix_in_them(entries, radius, exponent, log2):
    """If the rounded matrix is definite, so are all corners of the ball matrix, in any units.

    What is below a form is below it in other units, and is found there as well.
    """
    a, b, c = entries
    mids = np.array([[1 + abs(a), b], [b, 1 + abs(c)]])
    units = arb(2) ** exponent, arb(2) ** (exponent + log2)
    enclosed = [
        [arb(float(m), radius) * u * v for m, v in zip(row, units, strict=True)]
        for row, u in zip(mids, units, strict=True)
    ]
    corners = [mids + radius * np.array([[s, t], [t, u]]) for s, t, u in product((-1, 1), repeat=3)]
    smallest = min(np.linalg.eigvalsh(corner).min() for corner in corners)
    if is_positive_definite(lower(enclosed)):
        assert smallest > -1e-12
    else:
        assert smallest < 8 * radius + 1e-12


@pytest.mark.parametrize(
    ("rows", "integers"),
    [
        # An exact n x n matrix of largest entry 1, times 2^160, less n + 1 on the diagonal.
        ([[1]], [[2**160 - 2]]),
        ([[1, 0.5], [0.5, 1]], [[2**160 - 3, 2**159], [2**159, 2**160 - 3]]),
        ([[2, 0], [0, 0]], [[2**160 - 3, 0], [0, -3]]),
        # Of sizes 2^-20 and 1, weights 2^-10 and 1: less 1 + 2^-10 and 2^10 + 1, and one more.
        ([[arb(2) ** -20, 0], [0, 1]], [[2**140 - 2, 0], [0, 2**160 - 1026]]),
        # What is known to within zero only.
        ([[0]], [[-2]]),
        # What flint may take for zero counts on both sides, 2^-32767, in units of the largest.
        ([[arb(2) ** -32700]], [[2**160 - 2**93 - 2]]),
        ([[arb(2) ** -32769]], [[2**160 - 2**162 - 2]]),
        ([[arb(2) ** -32770]], [[-2]]),
        # What has more digits is rounded down, also below zero.
        ([[1, arb(3) * arb(2) ** -170], [0, 1]], [[2**160 - 3, 0], [0, 2**160 - 3]]),
        ([[1, arb(-3) * arb(2) ** -170], [0, 1]], [[2**160 - 3, -1], [-1, 2**160 - 3]]),
        # What is too large says nothing.
        ([[arb(2) ** 32767]], [[2**160 - 2]]),
        ([[arb(2) ** 32768]], [[0]]),
        ([[arb(2) ** 32768, 0], [0, 1]], [[0, 0], [0, 0]]),
    ],
)
def test_integers_by_hand(rows, integers):
    assert lower(rows) == integers


def test_a_radius_alone_counts_in_full():
    ball = arb(0, 0.25)
    mantissa, exponent = ball.rad().man_exp()
    radius = Fraction(int(mantissa)) * Fraction(2) ** int(exponent)
    assert lower([[ball]]) == [[-int(radius * 2**160 + 1) - 1]]


@pytest.mark.parametrize(
    "ball", [arb("nan"), arb("inf"), arb(1, float("inf")), arb(2) ** (10**15), arb(0, 2)]
)
def test_balls_that_say_nothing_prove_nothing(ball):
    with ends_soon():
        assert not is_positive_definite(lower([[ball]]))
        assert not is_positive_definite(lower([[ball, arb(0)], [arb(0), arb(1)]]))
        assert not is_positive_definite(lower([[arb(1), ball], [ball, arb(1)]]))


def test_tiny_balls_count_as_their_bound_and_not_as_nothing():
    tiny = arb(2) ** -(10**15)
    # [[0, t], [t, 1]] is not definite for any t > 0, however tiny.
    assert not is_positive_definite(lower([[arb(0), tiny], [tiny, arb(1)]]))
    assert not is_positive_definite(lower([[tiny, arb(0)], [arb(0), tiny]]))
    assert is_positive_definite(lower([[arb(1), tiny], [tiny, arb(1)]]))


def test_the_enclosure_is_not_a_point():
    with enclosure.precision(64):
        E = enclosure.exponential(RationalMatrix(((1, 2), (3, 4))), Fraction(1), Fraction(1))
    assert not E[0, 0].is_exact()


@pytest.mark.parametrize(("begin", "end"), [(0, 2), (1, 3)])
def test_the_enclosure_of_a_range_is_tight(begin, end):
    """Of ``exp(t)``, within one unit in a million."""
    with enclosure.precision():
        E = enclosure.exponential(RationalMatrix(((1,),)), Fraction(begin), Fraction(end))[0, 0]
        first, last = arb(begin).exp(), arb(end).exp()
        assert E.contains(first)
        assert E.contains(last)
        assert E.lower() > first - 1e-6
        assert E.upper() < last + 1e-6


@by_rows("shift", "radius", "met")
def test_balls_meet_where_every_entry_does(shift, radius, met):
    M, S = (
        RationalMatrix(((1, 2), (3, 4))),
        RationalMatrix.from_rows([[Fraction(entry) for entry in row] for row in shift]),
    )
    moved = RationalMatrix.from_rows(
        [
            [a + b for a, b in zip(*rows, strict=True)]
            for rows in zip(M.fractions(), S.fractions(), strict=True)
        ]
    )
    assert enclosure.overlap(enclosure.balls(M), moved, Fraction(radius)) is met


def test_the_precision_is_set_back_after_an_error():
    before = ctx.prec
    with pytest.raises(ZeroDivisionError), enclosure.precision(77):
        enclosure.balls(RationalMatrix(((1,),), 0))
    assert ctx.prec == before


@given(st.lists(st.integers(-9, 9), min_size=4, max_size=4), st.integers(0, 9), st.integers(0, 9))
def test_exponentials_against_pade(entries, begin, width):
    """Those of SciPy (Al-Mohy and Higham 2009), at both ends and in the middle of the times."""
    A = RationalMatrix((tuple(entries[:2]), tuple(entries[2:])), 10)
    first, last = Fraction(begin, 10), Fraction(begin + width, 10)
    with enclosure.precision():
        E = enclosure.exponential(A, first, last)
        for t in (first, (first + last) / 2, last):
            known = expm(np.array(A.floats()) * float(t))
            for i in range(2):
                for j in range(2):
                    assert arb(known[i, j], 1e-11 * np.abs(known).max()).overlaps(E[i, j])


@given(st.lists(st.integers(-9, 9), min_size=9, max_size=9), st.integers(1, 9))
def test_eigenvalues_add_up_to_the_trace_as_often_as_they_occur(entries, denominator):
    A = RationalMatrix(tuple(tuple(entries[k : k + 3]) for k in (0, 3, 6)), denominator)
    found = enclosure.eigenvalues(A)
    assert len(found) == 3
    assert sum(found, start=acb(0)).overlaps(acb(fmpq(sum(entries[::4]), denominator)))


def test_multiple_eigenvalues():
    assert len(enclosure.eigenvalues(RationalMatrix(((1, 0), (0, 1)), 2))) == 2


@by_rows("radius", "number", "sign")
def test_a_sign_of_the_characteristic_polynomial_is_certain(radius, number, sign):
    """Of ``z - 2``, with 2 off by no more than the radius."""
    M = arb_mat([[arb(2, radius)]])
    assert enclosure.characteristic_sign(M, Fraction(number)) == sign


@by_rows("low", "high", "is_between")
def test_an_eigenvalue_is_between_two_signs_that_are_certain(low, high, is_between):
    M = arb_mat([[arb(2, 0.5)]])
    assert (enclosure.eigenvector(M, Fraction(low), Fraction(high)) is not None) is is_between


def test_coordinates_in_which_a_form_is_round():
    """Forms of any size, nearly flat ones too; one that is not definite stays as it is."""
    with enclosure.precision():
        for rows in ([[4, 2], [2, 1 + 2**-40]], [[10**30, 0], [0, 1]], [[2, 1], [1, 3]]):
            form = enclosure.balls(
                RationalMatrix.from_rows([[Fraction(x) for x in row] for row in rows])
            )
            T = enclosure.unit_coordinates(form)
            around = T.transpose() * form * T
            assert all(T[i, j].is_exact() for i in range(2) for j in range(2))
            assert all(abs(around[i, j] - int(i == j)) < 1e-9 for i in range(2) for j in range(2))
        for rows in ([[1, 2], [2, 1]], [[0, 0], [0, 0]], [[1, 1], [1, 1]]):
            assert enclosure.unit_coordinates(enclosure.balls(RationalMatrix(rows))) == arb_mat(
                [[1, 0], [0, 1]]
            )
        # Definite, but of a root that is not invertible for certain.
        wide = arb(0.85, 0.28)
        form = arb_mat([[arb(0.73), wide], [wide, arb(1.86)]])
        assert enclosure.unit_coordinates(form) == arb_mat([[1, 0], [0, 1]])


def test_an_exact_ball_is_its_fraction():
    for number in (Fraction(3, 8), Fraction(-5), Fraction(0), Fraction(2**70 + 1, 2**90)):
        with enclosure.precision():
            assert enclosure.fraction_of(enclosure.ball_around(number)) == number
