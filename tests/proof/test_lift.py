"""Lifts of linear maps against direct evaluation, in integers."""

from math import comb, prod

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.proof.lift import derivative_lift, monomials, power_lift, vanishes

ENTRIES = st.integers(-9, 9)


@st.composite
def maps(draw):
    """Draw a matrix, a degree and a point."""
    n, degree = draw(st.integers(1, 4)), draw(st.integers(1, 4))
    rows = [[draw(ENTRIES) for _ in range(n)] for _ in range(n)]
    return rows, degree, [draw(ENTRIES) for _ in range(n)]


def lift_point(x, degree):
    return [prod(v**e for v, e in zip(x, a, strict=True)) for a in monomials(len(x), degree)]


def image(M, x):
    return [sum(a * b for a, b in zip(row, x, strict=True)) for row in M]


def test_the_cube_of_a_rotation_by_hand():
    # x1' = x2, x2' = -x1: (x1^2)' = 2 x1 x2, (x1 x2)' = x2^2 - x1^2, (x2^2)' = -2 x1 x2.
    assert monomials(2, 2) == ((2, 0), (1, 1), (0, 2))
    assert derivative_lift([[0, 1], [-1, 0]], 2) == [[0, 2, 0], [-1, 0, 1], [0, -2, 0]]
    # x1+ = x2, x2+ = -x1.
    assert power_lift([[0, 1], [-1, 0]], 2) == [[0, 0, 1], [0, -1, 0], [1, 0, 0]]


@pytest.mark.parametrize(("n", "degree"), [(1, 5), (2, 7), (3, 4), (5, 3), (8, 2)])
def test_all_monomials_of_one_degree(n, degree):
    found = monomials(n, degree)
    assert len(found) == len(set(found)) == comb(n + degree - 1, degree)
    assert all(len(a) == n and sum(a) == degree for a in found)


@given(maps())
def test_power_lift_is_the_lift_of_the_image(drawn):
    A, degree, x = drawn
    assert image(power_lift(A, degree), lift_point(x, degree)) == lift_point(image(A, x), degree)


@given(maps())
def test_derivative_lift_is_the_first_order_of_a_small_step(drawn):
    A, degree, x = drawn
    z = lift_point(x, degree)
    # (I + A/h) lifted is I + (A lifted)/h + O(1/h^2); exact for h huge, in integers h^d times that.
    h = 10**40
    step = [[h * (i == j) + entry for j, entry in enumerate(row)] for i, row in enumerate(A)]
    moved = lift_point(image(step, x), degree)
    change = [m - h**degree * v for m, v in zip(moved, z, strict=True)]
    slope = image(derivative_lift(A, degree), z)
    assert all(
        abs(c - s * h ** (degree - 1)) <= 10**20 * h ** max(degree - 2, 0)
        for c, s in zip(change, slope, strict=True)
    )


@given(maps(), st.randoms(use_true_random=False))
def test_forms_that_vanish_are_exactly_those_that_are_zero_everywhere(drawn, random):
    _, degree, x = drawn
    n, z = len(x), lift_point(x, degree)
    basis = monomials(n, degree)
    N = [[0] * len(basis) for _ in basis]
    for _ in range(4):
        i, j = random.randrange(len(basis)), random.randrange(len(basis))
        for k, a in enumerate(basis):
            for m, b in enumerate(basis):
                if tuple(map(sum, zip(a, b, strict=True))) == tuple(
                    map(sum, zip(basis[i], basis[j], strict=True))
                ):
                    weight = random.randint(-3, 3)
                    N[i][j] += weight
                    N[k][m] -= weight
    assert vanishes(N, n, degree)
    assert sum(N[i][j] * z[i] * z[j] for i in range(len(z)) for j in range(len(z))) == 0
    N[0][-1] += 1
    assert not vanishes(N, n, degree)


def test_the_smallest_form_that_vanishes():
    # x1^2 * x2^2 - (x1 x2)^2, as a symmetric matrix over the monomials of degree two.
    assert vanishes([[0, 0, 1], [0, -2, 0], [1, 0, 0]], 2, 2)
    assert not vanishes([[0, 0, 1], [0, -1, 0], [1, 0, 0]], 2, 2)
    assert not vanishes([[0, 0, 1], [0, -2, 0], [0, 0, 0]], 2, 2)


@pytest.mark.parametrize(("rows", "columns"), [(2, 3), (3, 2), (4, 3), (3, 4)])
def test_forms_of_another_size_are_an_error(rows, columns):
    with pytest.raises(ValueError, match=r"shorter|longer"):
        vanishes([[0] * columns] * rows, 2, 2)
