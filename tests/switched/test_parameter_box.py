"""Corners of a box: enough for the whole box, or the assembly stops."""

from fractions import Fraction
from itertools import product

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.errors import InternalError
from nrs_design.models.interval import Interval
from nrs_design.switched.parameter_box import Axis, box_corners

F = Fraction
UNIT = Interval(F(1), F(1), F(3))
X, Y = Axis("x", UNIT), Axis("y", Interval(F(2), F(-1), F(4)))
INVERSE = Axis("x", UNIT, inverse=True)
shares = st.fractions(0, 1, max_denominator=20)


def corners(axes, entry):
    return list(box_corners(axes, lambda values: [[F(entry(**values))]], "m"))


def test_labels_and_order():
    found = corners((X, Y), lambda x, y: 10 * x + y)
    assert [label for label, _ in found] == [
        "x-min/y-min",
        "x-min/y-max",
        "x-max/y-min",
        "x-max/y-max",
    ]
    assert [rows[0][0] for _, rows in found] == [9, 14, 29, 34]


def test_a_point_has_one_corner_without_a_label():
    point = Axis("x", Interval.point(F(2)))
    assert corners((point,), lambda x: x**5) == [("", [[32]])]


def test_middle_of_an_inverse_axis():
    # One over it is halfway between 1 and 1/3.
    assert (X.middle, INVERSE.middle) == (2, F(3, 2))


@given(st.lists(st.fractions(-9, 9), min_size=4, max_size=4), shares, shares)
def test_every_value_in_the_box_is_the_same_average_of_corners(c, s, t):
    """With x in the inverse: a + b/x + c y + d y/x."""

    def entry(x, y):
        return c[0] + c[1] / x + c[2] * y + c[3] * y / x

    found = corners((INVERSE, Y), entry)
    inverse = (1 - s) * 1 + s * F(1, 3)
    y = (1 - t) * Y.interval.low + t * Y.interval.high
    weights = [a * b for a, b in product((1 - s, s), (1 - t, t))]
    mean = sum(w * rows[0][0] for w, (_, rows) in zip(weights, found, strict=True))
    assert mean == entry(1 / inverse, y)


@pytest.mark.parametrize(
    ("axes", "entry"),
    [
        ((X,), lambda x: x**2),
        ((X,), lambda x: 1 / x),
        ((INVERSE,), lambda x: x),
        ((X, Y), lambda x, y: x * y**2),
        ((X, Y), lambda x, y: x**2 - 4 * x),
        # Affine along every edge, but not inside.
        ((X, Y), lambda x, y: (x - 1) * (x - 3) * (y + 1) * (y - 4)),
        # Odd about the middle, so that the middle of the box alone would not show it.
        ((X, Y), lambda x, y: (x - 2) * (y - F(3, 2)) ** 2),
    ],
)
def test_anything_else_stops_the_assembly(axes, entry):
    with pytest.raises(InternalError, match="mode m is not affine in each parameter"):
        corners(axes, entry)
