"""A motor under commands that take effect within a period: formulas, enclosures, known answers."""

from decimal import Decimal, localcontext
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from nrs_design.controllers.laws import Admittance
from nrs_design.controllers.step_law import StepFrame
from nrs_design.loop.command_timing import CommandTiming
from nrs_design.loop.held_motor import MotorAtOnce, MotorInTime, hold
from nrs_design.models.actuator import Actuator, ActuatorRanges
from nrs_design.models.interval import Interval
from tests.loop.frames import Frame

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


@pytest.mark.parametrize(("low", "high", "jitter"), [(0.2, 0.9, 0), (0, 2.6, 0), (1.3, 3.1, 0.2)])
def test_a_loop_with_a_log_of_late_commands_is_that_of_the_map(low, high, jitter):
    """Commands on their way in a list, the motor moved from event to event, and nothing shared."""
    rng = np.random.default_rng(7)
    Km, tau, Kp, D, k, a, b = 5e-4, 0.035, 117359.0, 1.03e6, 43.0, 0.65, 0.16
    step = float(T)
    law = Admittance.discrete(F(a), F(b), T)
    timing = CommandTiming(T, *(F(str(v)) * T for v in (low, high, jitter)))
    motor = MotorInTime.of(ActuatorRanges.point(Actuator(F(Km), F(tau))), timing)
    frame = Frame(timing, motor, StepFrame(F(Kp), F(D)), (law,), 0)
    names, n = [name.split(" [")[0] for name in frame.states], len(frame.states)
    lengths = rng.uniform(1 - jitter, 1 + jitter, 60) * step
    starts = np.concatenate([[0.0], np.cumsum(lengths)])
    comes = starts[:-1] + rng.choice([low, high, (low + high) / 2], 60) * step
    theta, omega, r, vm, before, sent = 0.0, 0.0, 0.02, 0.0, 0.0, [0.0] * 60
    for i, begin in enumerate(starts[:-1]):
        e = r - theta
        x = {"e": e, "omega": omega, "e before": before, "vm": vm, "delta": theta}
        x |= {f"u {age} before": sent[i - age] if i >= age else 0.0 for age in range(1, 5)}
        sent[i] = Kp * e + D * (e - before)
        r, vm, before = r - step * vm, a * vm + b * k * theta, e
        events = sorted({begin, starts[i + 1], *comes[(comes > begin) & (comes < starts[i + 1])]})
        for first, last in pairwise(events):
            known = [j for j in range(i + 1) if comes[j] <= first]
            u = sent[max(known)] if known else 0.0
            gone = -np.expm1(-(last - first) / tau)
            theta += tau * gone * omega + Km * ((last - first) - tau * gone) * u
            omega += gone * (Km * u - omega)
        if i < timing.oldest + 1:
            continue
        values = {"Km": F(Km), "g": F(1 / tau), "k": F(k)}
        since = [comes[i - age : i + 1].min() for age in timing.within]
        left = [starts[i + 1] - min(max(t, begin), starts[i + 1]) for t in since]
        for rest, time in zip(motor.spans, (lengths[i], *left), strict=True):
            way = -tau * np.expm1(-time / tau)
            chord = rest.low + rest.slope * (F(time) - rest.time.low)
            assert float(rest.time.low) - 1e-12 <= time <= float(rest.time.high) + 1e-12
            assert F(way) - chord - rest.rest.low >= -1e-15
            values |= dict(zip(rest.symbols, (F(time), F(way) - chord), strict=True))
        rows = np.array([[float(v) for v in row[:n]] for row in frame.rows(law, 0, values)[:n]])
        after = dict(zip(names, rows @ [x[name] for name in names], strict=True))
        wanted = {"omega": omega, "delta": theta, "e": r - theta, "vm": vm, "e before": before}
        for name, value in wanted.items():
            assert after[name] == pytest.approx(value, rel=1e-7, abs=1e-10), (i, name)
