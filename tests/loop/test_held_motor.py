"""A motor under commands that take effect within a period: formulas, enclosures, known answers."""

from decimal import Decimal, localcontext
from fractions import Fraction

from hypothesis import example, given
from hypothesis import strategies as st

from nrs_design.loop.command_timing import CommandTiming
from nrs_design.loop.held_motor import MotorAtOnce, MotorInTime, hold
from nrs_design.models.actuator import Actuator, ActuatorRanges
from nrs_design.models.interval import Interval

F = Fraction
T = F(1, 500)
RANGES = ActuatorRanges(
    Interval(F(1, 2), F(2, 5), F(3, 5)), Interval(F(7, 200), F(3, 100), F(1, 25)), "rpm"
)


def true_rest(span, time, tau):
    """Return what is left of the way of one motor above the chord of a span, to 50 digits."""
    with localcontext(prec=60):
        lag = Decimal(tau.numerator) / tau.denominator
        way = lag * (1 - (-Decimal(time.numerator) / time.denominator / lag).exp())
        return F(way) - span.low - span.slope * (time - span.time.low)


SHARE = st.fractions(0, 1)


@given(SHARE, SHARE, SHARE, st.sampled_from([1, F(4, 3), 3, 40]), st.sampled_from([1, 20]), SHARE)
# Of the slowest motor, the way rises above the chord of the fastest up to the longest period.
@example(1, 1, 0, 3, 20, F(7, 8))
def test_every_motor_at_every_time_is_enclosed(at, when, start, ratio, speed, jitter):
    """And what encloses it is hardly wider than it must be."""
    fastest = F(3, 100) / speed
    tau = Interval(fastest, fastest, ratio * fastest)
    ranges = ActuatorRanges(RANGES.gain, tau, "rpm")
    earliest = start * T / 2
    shaken = (F(1, 50) + jitter) * T * F(9, 10)
    motor = MotorInTime.of(ranges, CommandTiming(T, earliest, earliest + T / 3, shaken))
    for span in motor.spans:
        times = span.time
        time = times.low + when * (times.high - times.low)
        rest = true_rest(span, time, tau.low + at * (tau.high - tau.low))
        assert span.rest.low - F(1, 10**45) <= rest <= span.rest.high + F(1, 10**45)
        # Of second order in the times, and of first in the ranges.
        room = (times.high - times.low) ** 2 / tau.low
        room += times.high**2 * (1 / tau.low - 1 / tau.high)
        assert span.rest.high <= room + F(1, 10**12)


def test_whole_periods_are_those_of_a_command_at_once():
    for periods in range(3):
        motor = hold(RANGES, CommandTiming(T, periods * T, periods * T))
        assert isinstance(motor, MotorAtOnce)
        assert motor.box == MotorAtOnce.of(RANGES, T).box


def test_a_motor_that_is_known_has_enclosures_that_are_one_number_in_doubles():
    motor = hold(ActuatorRanges.point(Actuator(F(1, 2), F(7, 200))), CommandTiming(T, T / 3, T / 3))
    assert [*motor.box.ranges] == ["Km", "g", "s", "s0"]
    for symbol in ("s", "s0"):
        interval = motor.box.ranges[symbol]
        assert 0 < interval.high - interval.low < F(1, 10**18)
