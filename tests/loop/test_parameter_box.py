"""Corners of a box: enough for the whole box, or the assembly stops."""

from fractions import Fraction
from functools import cache
from itertools import product

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.errors import InternalError
from nrs_design.loop.parameter_box import Box
from nrs_design.models.interval import Interval

F = Fraction
UNIT = Interval(F(1), F(1), F(3))
X, Y = Box({"x": UNIT}), Box({"y": Interval(F(2), F(-1), F(4))})
INVERSE = Box({"x": UNIT}, frozenset({"x"}))
BOTH = X.join(Y)
shares = st.fractions(0, 1, max_denominator=20)


def corners(box, entry):
    return list(box.corners(lambda values: [[F(entry(**values))]], "m"))


def test_names_and_order():
    found = corners(BOTH, lambda x, y: 10 * x + y)
    assert [labels for labels, _ in found] == [*product(("x-min", "x-max"), ("y-min", "y-max"))]
    assert [rows[0][0] for _, rows in found] == [9, 14, 29, 34]


def test_a_point_has_one_corner_without_a_label():
    point = Box({"x": Interval.point(F(2))})
    assert corners(point, lambda x: x**5) == [((), [[32]])]


def test_middle_of_an_inverse_axis():
    """One over it is halfway between 1 and 1/3."""
    for box, middle in ((X, 2), (INVERSE, F(3, 2))):
        seen = []
        list(box.corners(lambda values, seen=seen: [[seen.append(values["x"]) or F(1)]], "m"))
        assert seen == [1, 3, middle]


@given(st.lists(st.fractions(-9, 9), min_size=4, max_size=4), shares, shares)
def test_every_value_in_the_box_is_the_same_average_of_corners(c, s, t):
    """With x in the inverse: a + b/x + c y + d y/x."""

    def entry(x, y):
        return c[0] + c[1] / x + c[2] * y + c[3] * y / x

    found = corners(INVERSE.join(Y), entry)
    inverse = (1 - s) * 1 + s * F(1, 3)
    y = (1 - t) * F(-1) + t * F(4)
    weights = [a * b for a, b in product((1 - s, s), (1 - t, t))]
    mean = sum(w * rows[0][0] for w, (_, rows) in zip(weights, found, strict=True))
    assert mean == entry(1 / inverse, y)


@pytest.mark.parametrize(
    ("box", "entry"),
    [
        (X, lambda x: x**2),
        (X, lambda x: 1 / x),
        (INVERSE, lambda x: x),
        (BOTH, lambda x, y: x * y**2),
        (BOTH, lambda x, y: x**2 - 4 * x),
        # Affine along every edge, but not inside.
        (BOTH, lambda x, y: (x - 1) * (x - 3) * (y + 1) * (y - 4)),
        # Odd about the middle, so that the middle of the box alone would not show it.
        (BOTH, lambda x, y: (x - 2) * (y - F(3, 2)) ** 2),
    ],
)
def test_anything_else_stops_the_assembly(box, entry):
    with pytest.raises(InternalError, match="mode m is not affine in each parameter"):
        corners(box, entry)


@pytest.mark.parametrize("power", [1, 2])
def test_rows_that_corners_share_are_compared_too(power):
    """A row that depends on one parameter alone may be one object along the axis of the other."""

    @cache
    def shared(x):
        return [x**power]

    def rows_at(values):
        return [shared(values["x"]), [values["x"] * values["y"]]]

    if power == 1:
        assert len(list(BOTH.corners(rows_at, "m"))) == 4
    else:
        with pytest.raises(InternalError, match="mode m is not affine in each parameter"):
            list(BOTH.corners(rows_at, "m"))


def test_a_symbol_stands_for_one_parameter():
    with pytest.raises(InternalError, match="the symbol x stands for two parameters"):
        BOTH.join(INVERSE)
