"""Sums of responses below a safety layer: known answers, sums in floats, and odd numbers."""

from dataclasses import astuple, replace
from fractions import Fraction
from functools import cache
from math import ceil

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.proof.safety import (
    Reach,
    SampledMotor,
    limits_of,
    reach_of,
    respond,
)
from tests.proof.systems import governed

LOOP = governed().safety
PERIOD = Fraction(1, 100)
# A motor that follows its command at once, but for what has no number: E is next to nothing.
QUICK = replace(
    LOOP,
    gain=(Fraction(1),) * 2,
    time_constant=(Fraction(1, 100_000),) * 2,
    Kp=Fraction(50),
    D=Fraction(0),
    oldest=0,
)


def near(number, wanted, share=1e-3):
    return float(number) == pytest.approx(wanted, rel=share)


def test_a_motor_without_lag_has_the_sums_of_a_geometric_series():
    """``e+ = e + r - e/2``: 1, 1/2, 1/4, ... sums to 2, changes to 2; the velocity is 50 e."""
    motor = SampledMotor.of(QUICK, PERIOD)
    found = respond(QUICK, motor, 60, 0)
    assert near(found.error.step, 2)
    assert near(found.error.change, 2)
    assert near(found.velocity.step, 100)
    assert near(found.command.step, 100)
    # The step of the sample whose torque was seen, and an error of twice the step that is made up.
    assert near(found.carry, 3)
    assert found.forward


def test_bounds_are_never_below_those_of_a_geometric_series():
    motor = SampledMotor.of(QUICK, PERIOD)
    A = np.array([[float(x) for x in row] for row in motor.matrix(QUICK)])
    sums, power = np.zeros(3), np.eye(3)
    for _ in range(200):
        sums += abs(power[:, 0])
        power = A @ power
    for horizon in (5, 20, 60):
        found = respond(QUICK, motor, horizon, 0)
        assert float(found.error.step) >= sums[0] * (1 - 1e-12)
        assert float(found.velocity.step) >= sums[2] * (1 - 1e-12)
    assert float(found.error.step) == pytest.approx(sums[0], rel=1e-12)


@pytest.mark.parametrize(("horizon", "decided"), [(1, False), (60, True)])
def test_a_horizon_before_the_end_of_the_response_decides_nothing(horizon, decided):
    motor = SampledMotor.of(LOOP, PERIOD)
    assert (respond(LOOP, motor, horizon, 1) is not None) == decided


def test_an_angle_that_goes_back_while_the_reference_goes_on_is_seen():
    """Sampled damping that is too strong swings the angle behind where it began."""
    motor = {"gain": (Fraction(1),) * 2, "time_constant": (Fraction(3, 1000),) * 2}
    for D, forward in ((160, False), (50, True)):
        loop = replace(LOOP, **motor, Kp=Fraction(100), D=Fraction(D))
        held = SampledMotor.of(loop, PERIOD)
        A, x, least = np.array([[float(v) for v in row] for row in held.matrix(loop)]), [1, 0, 0], 0
        for _ in range(200):
            x = A @ x
            least = min(least, 1 - x[0])
        assert (least >= 0) == forward
        assert respond(loop, held, 200, 0).forward == forward


@cache
def limits_below(loop):
    """Return what a loop keeps, by iteration from nothing."""
    motor = SampledMotor.of(loop, PERIOD)
    found = respond(loop, motor, 68, loop.oldest)
    reach = Reach(*[Fraction(0)] * 4)
    for _ in range(30):
        # Short numbers that are not below.
        numbers = astuple(reach_of(loop, motor, found, reach))
        reach = Reach(*(Fraction(ceil(n * 2**40), 2**40) for n in numbers))
    return limits_of(loop, PERIOD, motor, found, reach)


@given(
    st.lists(st.sampled_from([-1.0, 1.0]), min_size=1, max_size=40),
    st.floats(0, 1),
    st.floats(0, 1),
)
def test_no_steps_of_the_reference_leave_the_reach(signs, gain, tau):
    """Any motor of the ranges, held for the run, with steps of the largest size."""
    limits = limits_below(LOOP)
    low, high = LOOP.gain
    Km = float(low) + gain * float(high - low)
    fast, slow = LOOP.time_constant
    lag = float(fast) + tau * float(slow - fast)
    E, T = np.exp(-float(PERIOD) / lag), float(PERIOD)
    s = lag * (1 - E)
    e = before = w = 0.0
    for sign in signs * 3:
        u = float(LOOP.Kp) * e + float(LOOP.D) * (e - before)
        assert abs(u) <= float(limits.command)
        before, e = e, e + sign * float(LOOP.step) - s * w - Km * (T - s) * u
        w = E * w + Km * (1 - E) * u
        assert abs(e) <= float(limits.error)
        assert abs(w) <= float(limits.velocity)


def test_a_reach_that_is_claimed_too_small_is_not_kept():
    motor = SampledMotor.of(LOOP, PERIOD)
    found = respond(LOOP, motor, 68, 1)
    for number in astuple(reach_of(LOOP, motor, found, Reach(*[Fraction(0)] * 4))):
        assert number > 0


def test_what_disturbs_makes_every_limit_larger():
    quiet = replace(
        LOOP, **dict.fromkeys(("encoder", "sensor", "friction", "damping"), Fraction(0))
    )
    base = limits_below(quiet)
    rubbed = limits_below(replace(quiet, friction=LOOP.friction))
    assert all(a < b for a, b in zip(astuple(base)[:7], astuple(rubbed)[:7], strict=True))
    seen = limits_below(replace(quiet, sensor=Fraction(1, 10)))
    assert seen.torque == base.torque + Fraction(1, 10) * 2
    assert seen.steady == base.steady + Fraction(1, 10)
    damped = limits_below(replace(quiet, damping=Fraction(1, 8)))
    # What hides in a retreat, over the stiffness, and what presses in addition.
    pressing = base.velocity / 8
    assert damped.torque == base.torque + pressing * 2 + pressing
    assert damped.steady == base.steady + 2 * pressing
    older = limits_below(replace(quiet, oldest=3))
    # Two samples more are two steps more.
    assert older.depth - base.depth == pytest.approx(float(2 * quiet.step), rel=1e-6)


ODD = {
    "gain": (Fraction(0), Fraction(1)),
    "time_constant": (Fraction(2), Fraction(1)),
    "stiffness": (Fraction(-1), Fraction(1)),
    "Kp": Fraction(0),
    "tick": Fraction(0),
    "speed": Fraction(0),
    "energy": Fraction(0),
    "angle": Fraction(0),
    "D": Fraction(-1),
    "refill": Fraction(-1),
    "encoder": Fraction(-1),
    "sensor": Fraction(-1),
    "friction": Fraction(-1),
    "damping": Fraction(-1),
    "command": Fraction(-1),
    "oldest": -1,
    "torque": Fraction(1, 2**21),
}


@pytest.mark.parametrize("key", ODD)
def test_numbers_that_no_layer_has_are_found(key):
    assert LOOP.find_odd() is None
    assert replace(LOOP, command=None).find_odd() is None
    assert replace(LOOP, **{key: ODD[key]}).find_odd() is not None
