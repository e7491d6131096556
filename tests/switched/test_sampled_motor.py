"""Where the numbers of a sampled motor lie."""

from fractions import Fraction as F

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.models.actuator import ActuatorRanges
from nrs_design.proof.taylor import exponential_between
from nrs_design.spec.interval import Interval
from nrs_design.switched.sampled_motor import EXPONENTIAL_BITS, RANGED_BITS, motor_box

PERIOD, TAU, KM = F(1, 500), F("0.0351"), F("4.8417e-4")
shares = st.fractions(0, 1, max_denominator=1000)


def box_of(low, high, period=PERIOD):
    tau = Interval(low, low, high)
    return motor_box(ActuatorRanges(Interval.point(KM), tau, "rpm"), period)


def is_inside(box, tau, period):
    """Tell whether E and s of a motor are in the triangle of a box, whatever E is in its bounds."""
    E, s = box.ranges["E"], box.ranges["s"]
    low, high = exponential_between(-period / tau)

    def line(x):
        return s.low + (s.high - s.low) * (x - E.low) / (E.high - E.low)

    # What lies above the chord at the upper bound of E, where s is least and the chord is highest,
    # does so at the true E.
    return (
        E.low <= low and high <= E.high and tau * (1 - low) <= s.high and tau * (1 - high) >= s.low
    ) and tau * (1 - high) >= line(high)


@given(
    st.fractions(F(1, 500), 1),
    st.fractions(F(1, 10**9), 10),
    st.fractions(F(1, 5000), F(1, 20)),
    st.lists(shares, min_size=1, max_size=5),
)
def test_every_motor_of_the_range_is_in_the_triangle(low, wide, period, inside):
    """Its ends too, and however narrow or wide the range is."""
    high = low * (1 + wide)
    box = box_of(low, high, period)
    assert all(is_inside(box, low + t * (high - low), period) for t in (F(0), F(1), *inside))


@pytest.mark.parametrize(("symbol", "end"), [("E", "low"), ("E", "high"), ("s", "low")])
def test_a_corner_rounded_inwards_leaves_a_motor_out(symbol, end):
    """By one unit of E, so none of the three is wider than it must be by much."""
    box = box_of(TAU * F(9, 10), TAU * F(11, 10))
    interval = box.ranges[symbol]
    unit = F(1, 2**RANGED_BITS)
    moved = {"low": interval.low, "high": interval.high}
    moved[end] += 2 * unit if end == "low" else -2 * unit
    box = type(box)({**box.ranges, symbol: Interval(F(0), **moved)}, chord=box.chord)
    assert not all(is_inside(box, end, PERIOD) for end in (TAU * F(9, 10), TAU * F(11, 10)))


def test_between_the_ends_the_curve_is_above_the_chord_and_below_the_corner():
    """By more than what is rounded: so the chord is the lower side, and the corner is needed."""
    period, tau = F(1, 20), TAU
    box = box_of(tau / 2, tau * 2, period)
    E, s = box.ranges["E"], box.ranges["s"]
    e, _ = exponential_between(-period / tau)
    share = (e - E.low) / (E.high - E.low)
    assert s.low + share * (s.high - s.low) < tau * (1 - e) - F(1, 10**4)
    assert tau * (1 - e) < s.high


def test_three_corners_of_four():
    def rows_at(values):
        return [[values["E"], values["s"]]]

    names = [name for name, _ in box_of(TAU, 2 * TAU).corners(rows_at, "m")]
    assert names == ["m/E-min/s-min", "m/E-min/s-max", "m/E-max/s-max"]


def test_a_known_time_constant_leaves_the_two_ends_of_its_exponential():
    box = box_of(TAU, TAU)
    assert box.ranges.keys() == {"Km", "E"}
    assert box.chord is None
    low, high = exponential_between(-PERIOD / TAU)
    E = box.ranges["E"]
    assert E.low <= low < high <= E.high
    assert E.high - E.low == F(1, 2**EXPONENTIAL_BITS)
    assert float(E.low) == float(E.high)
