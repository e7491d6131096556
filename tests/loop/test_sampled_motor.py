"""Where the numbers of a sampled motor lie."""

from dataclasses import replace
from fractions import Fraction as F

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.loop.parameter_box import Box
from nrs_design.loop.sampled_motor import EXPONENTIAL_BITS, motor_box
from nrs_design.models.actuator import ActuatorRanges
from nrs_design.models.interval import Interval
from nrs_design.proof.taylor import exponential_between

PERIOD, TAU, KM = F(1, 500), F("0.0351"), F("4.8417e-4")
shares = st.fractions(0, 1, max_denominator=1000)


def box_of(low, high, period=PERIOD):
    tau = Interval(low, low, high)
    return motor_box(ActuatorRanges(Interval.point(KM), tau, "rpm"), period)


def is_inside(box, tau, period):
    """Tell whether E and s of a motor are in the triangle of a box, wherever its bounds leave E."""
    E, s = box.ranges["E"], box.ranges["s"]
    first, corner, last = (E.low, s.low), box.triangle.between, (E.high, s.high)
    low, high = exponential_between(-period / tau)
    low = max(low, F(0))
    # True E and s are between these, and all sides rise.
    above, below = (low, tau * (1 - low)), (high, tau * (1 - high))
    return (
        side(first, last, below) >= 0 >= side(first, corner, above)
        and side(corner, last, above) <= 0
        and E.low <= low
        and high <= E.high
    )


def side(a, b, point):
    """Positive above the line from a to b."""
    return (b[0] - a[0]) * (point[1] - a[1]) - (b[1] - a[1]) * (point[0] - a[0])


@given(
    st.fractions(F(1, 500), 1),
    st.fractions(F(1, 10**9), 10),
    st.one_of(st.fractions(F(1, 5000), F(1, 20)), st.fractions(F(1, 20), 20)),
    st.lists(shares, min_size=1, max_size=5),
)
def test_every_motor_of_the_range_is_in_the_triangle(low, wide, period, inside):
    """Its ends too, and however narrow or wide the range is."""
    high = low * (1 + wide)
    box = box_of(low, high, period)
    assert all(is_inside(box, low + t * (high - low), period) for t in (F(0), F(1), *inside))


@pytest.mark.parametrize("moved", [{"E": (1, 0)}, {"E": (0, -1)}, {"s": (1, 0)}, {"between": -1}])
def test_a_corner_moved_inwards_leaves_a_motor_out(moved):
    """By a hundredth of the range, so no corner is further out than it must be by much."""
    low, high = TAU * F(9, 10), TAU * F(11, 10)
    box = box_of(low, high)
    ranges, triangle = dict(box.ranges), box.triangle
    for symbol, shifts in moved.items():
        size = ranges["s" if symbol == "between" else symbol]
        hundredth = (size.high - size.low) / 100
        if symbol == "between":
            E, s = triangle.between
            triangle = replace(triangle, between=(E, s + shifts * hundredth))
        else:
            ends = (
                end + n * hundredth for end, n in zip((size.low, size.high), shifts, strict=True)
            )
            ranges[symbol] = Interval(F(0), *ends)
    box = Box(ranges, triangle=triangle)
    assert not all(is_inside(box, low + F(i, 10) * (high - low), PERIOD) for i in range(11))


@pytest.mark.parametrize("period", [F(1, 500), F(1, 50), F(1, 20)])
def test_no_corner_is_far_from_a_motor(period):
    """So what is refuted there is hardly refuted wrongly: a share of T - s, the way of the motor.

    The corner of a box, at the E of the fastest and the s of the slowest, is 18 % off at 2 ms.
    """
    tau = TAU * F(9, 10), TAU * F(11, 10)
    box = box_of(*tau, period)
    s = box.ranges["s"]
    corners = (box.ranges["E"].low, s.low), box.triangle.between, (box.ranges["E"].high, s.high)
    for E, found in corners:
        motor = period * (1 - float(E)) / -np.log(float(E))
        assert abs(float(found) - motor) <= 0.002 * (float(period) - motor)


def test_no_corner_is_a_motor_that_does_not_slow_down():
    box = box_of(TAU / 100, TAU * 100, F(1, 10**4))
    E = box.ranges["E"]
    assert 0 < E.low < E.high < 1
    assert all(is_inside(box, TAU * 10**i, F(1, 10**4)) for i in (-2, -1, 0, 1, 2))


def test_three_corners():
    def rows_at(values):
        return [[values["E"], values["s"]]]

    names = [name for name, _ in box_of(TAU, 2 * TAU).corners(rows_at, "m")]
    assert names == ["m/E-min/s-min", "m/E-min/s-max", "m/E-max/s-max"]


def test_a_known_time_constant_leaves_the_two_ends_of_its_exponential():
    box = box_of(TAU, TAU)
    assert box.ranges.keys() == {"Km", "E"}
    assert box.triangle is None
    low, high = exponential_between(-PERIOD / TAU)
    E = box.ranges["E"]
    assert E.low <= low < high <= E.high
    assert E.high - E.low == F(1, 2**EXPONENTIAL_BITS)
    assert float(E.low) == float(E.high)
