"""Sums of responses below a safety layer: known answers, sums in floats, and odd numbers."""

from dataclasses import astuple, replace
from decimal import Decimal, localcontext
from fractions import Fraction
from functools import cache
from itertools import product
from math import ceil

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.proof.safety import (
    Reach,
    Response,
    Responses,
    SampledMotor,
    limits_of,
    reach_of,
    respond,
)
from tests.proof.systems import governed

F = Fraction
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


@pytest.mark.parametrize(("Kp", "horizon"), [(50, 5), (50, 60), (5, 20), (5, 60)])
def test_bounds_are_never_below_those_of_a_geometric_series(Kp, horizon):
    """What is behind the horizon is counted: of ``0.95^j``, a twentieth after sixty samples."""
    loop = replace(QUICK, Kp=F(Kp))
    motor = SampledMotor.of(loop, PERIOD)
    A = np.array([[float(x) for x in row] for row in motor.matrix(loop)])
    sums, power = np.zeros((3, 3)), np.eye(3)
    for _ in range(2000):
        sums += abs(power)
        power = A @ power
    found = respond(loop, motor, horizon, 0)
    for response, row in ((found.error, 0), (found.velocity, 2)):
        assert float(response.step) >= sums[row, 0] * (1 - 1e-12)
        assert float(response.spin) >= sums[row, 2] * (1 - 1e-12)
    if (Kp, horizon) == (50, 60):
        assert float(found.error.step) == pytest.approx(sums[0, 0], rel=1e-12)


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
        for _ in range(60):
            x = A @ x
            least = min(least, 1 - x[0])
        assert (least >= 0) == forward
        assert respond(loop, held, 60, 0).forward == forward


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
    "time_constant": (Fraction(0), Fraction(1)),
    "stiffness": (Fraction(2), Fraction(1)),
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


FINE = {
    "gain": (F(1),) * 2,
    "time_constant": (F(1),) * 2,
    "stiffness": (F(1),) * 2,
    **dict.fromkeys(("D", "refill", "encoder", "sensor", "friction", "damping"), F(0)),
    "torque": F(1, 2**20),
}


@pytest.mark.parametrize("key", FINE)
def test_numbers_at_their_edges_are_those_of_a_layer(key):
    assert replace(LOOP, **{key: FINE[key]}).find_odd() is None


@pytest.mark.parametrize("key", ["gain", "time_constant", "stiffness"])
@pytest.mark.parametrize("ends", [(F(0), F(1)), (F(2), F(1)), (F(-1), F(1))])
def test_a_range_begins_above_zero_and_ends_above_its_beginning(key, ends):
    assert replace(LOOP, **{key: ends}).find_odd() is not None


def test_a_step_is_within_the_largest_angle():
    """Else the rounding of a reference is not that of the largest angle."""
    edge = LOOP.angle / LOOP.tick
    assert replace(LOOP, speed=edge).find_odd() is None
    assert "largest angle" in replace(LOOP, speed=edge + 1).find_odd()


@pytest.mark.parametrize(("oldest", "fine"), [(0, True), (1000, True), (1001, False)])
def test_an_age_is_from_zero_to_a_thousand_samples(oldest, fine):
    assert (replace(LOOP, oldest=oldest).find_odd() is None) == fine


@pytest.mark.parametrize("key", ODD)
def test_numbers_that_no_layer_has_are_found(key):
    assert LOOP.find_odd() is None
    assert replace(LOOP, command=None).find_odd() is None
    assert replace(LOOP, **{key: ODD[key]}).find_odd() is not None


TINY = F(1, 2**22)


def spread(number, low, high):
    """Tell whether an interval holds another, and is hardly wider."""
    middle, radius = number
    return (
        low - F(1, 10**13) < middle - radius <= low < high <= middle + radius < high + F(1, 10**13)
    )


def decimal(number):
    return Decimal(number.numerator) / Decimal(number.denominator)


def test_steps_and_noise_have_the_rounding_of_the_largest_angle():
    assert LOOP.step == LOOP.tick * LOOP.speed * (1 + TINY) + LOOP.angle * TINY
    assert LOOP.noise == LOOP.encoder + LOOP.angle * TINY


def test_the_motor_is_enclosed_between_its_ends():
    with localcontext(prec=60):
        T = decimal(PERIOD)
        ends = []
        for tau in map(decimal, LOOP.time_constant):
            E = (-T / tau).exp()
            ends.append((F(E), F(tau * (1 - E))))
    (E_fast, s_fast), (E_slow, s_slow) = ends
    (least, most), motor = LOOP.gain, SampledMotor.of(LOOP, PERIOD)
    assert spread(motor.E, E_fast, E_slow)
    assert spread(motor.s, s_fast, s_slow)
    assert spread(motor.g, least * (PERIOD - s_slow), most * (PERIOD - s_fast))
    assert spread(motor.h, least * (1 - E_slow), most * (1 - E_fast))
    assert all((middle * 2**48).denominator == 1 for middle, _ in astuple(motor))


def test_a_motor_that_hardly_moves_in_a_period_is_not_driven_back():
    slow = replace(LOOP, time_constant=(F(10**12),) * 2)
    assert SampledMotor.of(slow, PERIOD).g[0] >= 0


MOTOR = SampledMotor(
    E=(F(1, 2), F(1, 101)), s=(F(1, 3), F(1, 103)), g=(F(1, 5), F(1, 107)), h=(F(1, 7), F(1, 109))
)
FOUND = Responses(
    error=Response(F(2), F(3), F(5)),
    change=Response(F(7), F(11), F(13)),
    velocity=Response(F(17), F(19), F(23)),
    command=Response(F(29), F(31), F(37)),
    carry=F(41),
    forward=True,
)
REACH = Reach(F(43), F(47), F(53), F(59))


def test_the_matrix_is_the_step_of_the_loop():
    e, before, w = F(3), F(5), F(7)
    u = LOOP.Kp * e + LOOP.D * (e - before)
    (E, _), (s, _), (g, _), (h, _) = astuple(MOTOR)
    rows = MOTOR.matrix(LOOP)
    after = [sum(a * x for a, x in zip(row, (e, before, w), strict=True)) for row in rows]
    assert after == [e - s * w - g * u, e, E * w + h * u]


def strays(lost):
    turned = F(1, 103) * 53 + F(1, 107) * 59 + (F(1, 5) + F(1, 107)) * lost
    spun = F(1, 101) * 53 + F(1, 109) * 59 + (F(1, 7) + F(1, 109)) * lost
    return turned, spun


ROUNDED = TINY * (LOOP.Kp * 43 + LOOP.D * 47) + F(1, 2**100)


def test_the_reach_is_the_sum_of_what_acts():
    turned, spun = strays(LOOP.friction + ROUNDED)
    step, noise = LOOP.step + turned, LOOP.noise
    assert astuple(reach_of(LOOP, MOTOR, FOUND, REACH)) == (
        2 * step + 3 * noise + 5 * spun,
        7 * step + 11 * noise + 13 * spun,
        17 * step + 19 * noise + 23 * spun,
        29 * step + 31 * noise + 37 * spun,
    )


def test_the_limits_follow_from_the_reach():
    most = limits_of(LOOP, PERIOD, MOTOR, FOUND, REACH)
    turned, spun = strays(LOOP.friction + ROUNDED)
    velocity = 53 + 2 * (F(1, 7) + F(1, 109)) * LOOP.friction
    stray = 2 * turned + 5 * spun + (3 + 1) * LOOP.noise
    depth = 41 * LOOP.step + 2 * stray + velocity * PERIOD / 2
    damped = LOOP.damping * velocity
    seen = LOOP.torque * (1 + TINY) + LOOP.sensor + damped
    low, high = LOOP.stiffness
    assert most.velocity == velocity
    assert most.error == 43 + LOOP.noise
    assert most.command == 59 + ROUNDED
    assert most.depth == depth
    assert most.torque == high * (seen / low + depth) + damped
    assert most.steady == seen + high * depth + damped
    ends = [(seen + k * depth) ** 2 / (2 * k) for k in (low, high)]
    assert most.stored == max(ends)
    # Where the reference is rounded, it goes on by more than what is booked.
    unbooked = (most.torque + LOOP.sensor) * (1 + TINY) * LOOP.angle * TINY
    assert most.lost == 2 * TINY * (LOOP.energy + LOOP.refill) + unbooked + F(1, 2**100)
    soft = replace(LOOP, stiffness=(F(1, 10**6), high))
    assert limits_of(soft, PERIOD, MOTOR, FOUND, REACH).stored > 10**3 * most.stored / 10**6


@cache
def true_powers(loop=LOOP, count=400):
    """A^0, A^1, ... of a loop with 60 digits, until nothing is left."""
    with localcontext(prec=60):
        rows = SampledMotor.of(loop, PERIOD).matrix(loop)
        A = [[decimal(v) for v in row] for row in rows]
        P = [[Decimal(int(i == j)) for j in range(3)] for i in range(3)]
        powers = []
        for _ in range(count):
            powers.append(P)
            P = [[sum(A[i][k] * P[k][j] for k in range(3)) for j in range(3)] for i in range(3)]
    return powers


def true_sums(loop=LOOP):
    """Sums of the responses of error, change, velocity and command."""
    Kp, D = decimal(loop.Kp), decimal(loop.D)
    rows = {
        "error": (1, 0, 0),
        "change": (1, -1, 0),
        "velocity": (0, 0, 1),
        "command": (Kp + D, -D, 0),
    }
    for name, row in rows.items():
        step, spin = (
            [sum(c * P[i][k] for i, c in enumerate(row)) for P in true_powers(loop)] for k in (0, 2)
        )
        jumps = [abs(b - a) for a, b in zip([Decimal(0), *step], step, strict=False)]
        yield name, (sum(map(abs, step)), sum(jumps), sum(map(abs, spin)))


def true_carry(oldest, loop=LOOP):
    h = [1 - P[0][0] for P in true_powers(loop)]
    h = [Decimal(0)] * (oldest + 1) + h
    ends = [*h, *([Decimal(1)] * len(h))]
    return max(sum(abs(ends[q + M] - ends[q]) for q in range(len(h))) for M in range(1, len(h)))


@pytest.mark.parametrize(("horizon", "share"), [(20, 0.2), (30, 0.02), (120, 1e-14)])
def test_sums_are_not_too_small_and_hardly_too_large(horizon, share):
    found = respond(LOOP, SampledMotor.of(LOOP, PERIOD), horizon, 1)
    for name, wanted in true_sums():
        for number, true in zip(astuple(getattr(found, name)), wanted, strict=True):
            assert F(true) * (1 - F(1, 10**40)) <= number <= F(true) * (1 + F(share)), name


@pytest.mark.parametrize("oldest", [0, 1, 4])
def test_the_way_on_is_not_too_small_and_hardly_too_large(oldest):
    motor, wanted = SampledMotor.of(LOOP, PERIOD), F(true_carry(oldest))
    for horizon, share in ((20, 0.5), (120, 1e-12)):
        carry = respond(LOOP, motor, horizon, oldest).carry
        assert wanted * (1 - F(1, 10**20)) <= carry <= wanted * (1 + F(share))


@pytest.mark.parametrize("oldest", [0, 2])
def test_an_angle_that_swings_about_the_reference_goes_on_by_more_than_its_error(oldest):
    """``e+ = e + r - 1.9 e``: two samples apart the angle is alike, one sample apart it is not."""
    loop = replace(QUICK, Kp=F(190))
    motor = SampledMotor.of(loop, PERIOD)
    found = respond(loop, motor, 250, oldest)
    A = np.array([[float(v) for v in row] for row in motor.matrix(loop)])
    x, error = np.array([1.0, 0, 0]), []
    for _ in range(500):
        error.append(x[0])
        x = A @ x
    h = np.concatenate([np.zeros(oldest + 1), 1 - np.array(error), np.ones(600)])
    wanted = max(abs(h[M:] - h[:-M]).sum() for M in range(1, 500))
    assert wanted > sum(map(abs, error)) + oldest + 1
    assert wanted * (1 - 1e-9) <= float(found.carry) <= wanted * (1 + 1e-6)


# Few binary digits, so that what is rounded shows: as it is computed, and not too small.
COARSE = {
    (20, 1): (F(2111, 256), [F(208835, 39168), F(108457, 39168), F(1625, 4896)]),
    (68, 1): (F(2255, 256), [F(3457, 616), F(65631, 19712), F(18763, 19712)]),
}


@pytest.mark.parametrize(("horizon", "oldest"), COARSE)
def test_what_is_rounded_is_counted_once(horizon, oldest, monkeypatch):
    monkeypatch.setattr("nrs_design.proof.safety.SUM_BITS", 8)
    found = respond(LOOP, SampledMotor.of(LOOP, PERIOD), horizon, oldest)
    assert (found.carry, [*astuple(found.error)]) == COARSE[horizon, oldest]


@pytest.mark.parametrize("Kp", [15, 60])
@pytest.mark.parametrize("D", [0, 3])
def test_coarse_sums_are_not_too_small(Kp, D, monkeypatch):
    loop = replace(LOOP, Kp=F(Kp), D=F(D))
    motor = SampledMotor.of(loop, PERIOD)
    sums, ways = dict(true_sums(loop)), {oldest: true_carry(oldest, loop) for oldest in (0, 3)}
    decided = 0
    for bits in range(7, 14):
        monkeypatch.setattr("nrs_design.proof.safety.SUM_BITS", bits)
        for horizon, oldest in product((12, 25, 60, 90), ways):
            if (found := respond(loop, motor, horizon, oldest)) is None:
                continue
            decided += 1
            assert found.carry >= F(ways[oldest])
            for name, wanted in sums.items():
                each = zip(astuple(getattr(found, name)), wanted, strict=True)
                assert all(number >= F(true) for number, true in each), (bits, horizon, name)
    assert decided > 5


@pytest.mark.parametrize(
    ("horizon", "oldest", "carry"),
    [(60, 0, F(75217, 4096)), (60, 2, F(76821, 4096)), (150, 2, F(76687, 4096))],
)
def test_what_is_rounded_is_counted_once_where_the_angle_swings(
    horizon, oldest, carry, monkeypatch
):
    """Then the most is found between samples of the horizon, not behind it."""
    monkeypatch.setattr("nrs_design.proof.safety.SUM_BITS", 12)
    swings = replace(QUICK, Kp=F(190))
    assert respond(swings, SampledMotor.of(swings, PERIOD), horizon, oldest).carry == carry


@pytest.mark.parametrize(("horizon", "forward"), [(6, False), (20, True)])
def test_what_may_be_left_behind_the_horizon_may_go_back(horizon, forward):
    assert respond(LOOP, SampledMotor.of(LOOP, PERIOD), horizon, 0).forward == forward
