"""What a drive does in a period: true maps lie between the points of its flow."""

import random
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise

import mpmath as mp
import numpy as np
import pytest

from nrs_design.controllers.laws import Admittance
from nrs_design.controllers.step_law import StepFrame
from nrs_design.errors import AssemblyError
from nrs_design.loop import hull
from nrs_design.loop.calendar import CommandTiming
from nrs_design.loop.flow import HELD_LOAD, HeldDrive
from nrs_design.loop.hull import enclose_box
from nrs_design.loop.sampled import DELTA
from nrs_design.loop.sampled_modes import anything_of
from nrs_design.models.contact.elastic import Elastic
from nrs_design.models.contact.environment import Environment
from nrs_design.models.drive import (
    LOAD,
    MEMORY,
    CommandInterface,
    lagging_drive,
    motor_drive,
    position_drive,
    torque_drive,
    velocity_drive,
)
from nrs_design.models.interval import Interval
from nrs_design.models.motion_loop import MotionLoop
from tests.loop.frames import Frame
from tests.loop.support import outside
from tests.loop.test_entries import DRIVES

F = Fraction
T = F(1, 500)
SECOND = MotionLoop((F(900),), (F(1), F(60), F(900)))
ZEROED = MotionLoop((F(28), F(1619)), (F(1), F(57), F(1619)))
THIRD = MotionLoop((F(10**5),), (F(1), F(160), F(8500), F(10**5)))
FOURTH = MotionLoop((F(10**7),), (F(1), F(260), F(24500), F(950000), F(10**7)))
KNOWN, AIR = Interval.point, {}


def some(rng, low, high, wide):
    """Return a number, and a narrow or wide range around it."""
    first = F(f"{10 ** rng.uniform(np.log10(low), np.log10(high)):.4g}")
    last = first * F(rng.choice(["1.0001", "1.02", "1.3", "3"]) if wide else "1")
    return Interval((first + last) / 2, first, last, rng.random() < 0.7)


def draw(rng):
    """Return a drive, its timing and what it touches, with a few ranges."""

    def wide():
        return rng.random() < 0.5

    kind = rng.choice(["motor", "loaded", "torque", "lag", SECOND, ZEROED, THIRD, "velocity"])
    if kind in ("motor", "loaded"):
        load = F(f"{rng.uniform(0.01, 1):.3g}") if kind == "loaded" else None
        drive = motor_drive(some(rng, 1e-4, 10, wide()), some(rng, 1e-3, 0.1, wide()), load)
    elif kind == "torque":
        drive = torque_drive(some(rng, 0.05, 0.5, wide()), some(rng, 0.05, 2, wide()))
    elif kind == "lag":
        drive = lagging_drive(some(rng, 1e-3, 0.1, wide()))
    else:
        drive = velocity_drive(ZEROED) if kind == "velocity" else position_drive(kind)
    if rng.random() < 0.3:
        drive = drive.remembering("d", [some(rng, 1, 50, wide()) for _ in MEMORY])
    period = F(f"{10 ** rng.uniform(-3.3, -1.7):.3g}")
    first = rng.choice([0, period * F(rng.randint(0, 20), 10)])
    last = first + rng.choice([0, period * F(rng.randint(0, 10), 10)])
    timing = CommandTiming(period, first, last, rng.choice([0, 0, 0, F(1, 5)]) * period)
    touched = {}
    if drive.loaded and rng.random() < 0.8:
        damping = some(rng, 0.05, 2, wide()) if wide() else KNOWN(F(0))
        touched = {"k": some(rng, 5, 200, wide()), "b": damping}
    return drive, timing, touched


def inside(rng, interval):
    """Return a number of an interval, often an end."""
    share = rng.choice([0, 1]) if rng.random() < 0.4 else mp.mpf(rng.random())
    low, high = (mp.mpf(end.numerator) / end.denominator for end in (interval.low, interval.high))
    return low + share * (high - low)


def matrix(M, values, inverse, shape):
    total = mp.zeros(*shape)
    for symbols, rows in M.terms.items():
        factor = mp.fprod(1 / values[s] if s in inverse else values[s] for s in symbols)
        for i, row in enumerate(rows):
            for j, c in enumerate(row):
                total[i, j] += factor * c.numerator / c.denominator
    return total


def true_rows(drive, lefts, come, loads):
    """What a period makes of states, deflection, command and its changes, to 50 digits.

    `lefts` are what is left of the period at each change, `come` whether it has taken effect at
    all. `loads` are shares of the period with the numbers that are then in force.
    """
    n, size = drive.order, drive.order + len(lefts)
    ends = [sum(share for share, _ in loads[: i + 1]) * lefts[0] for i in range(len(loads))]
    ends[-1] = lefts[0]
    z = mp.zeros(n, size)
    for i in range(n):
        z[i, i] = 1
    for begin, end in pairwise(sorted({mp.mpf(0), *ends, *(lefts[0] - h for h in lefts)})):
        middle = (begin + end) / 2
        values = next(v for (_, v), last in zip(loads, ends, strict=True) if middle < last)
        G = matrix(drive.rates, values, drive.inverse, (n + 1, n + 1))
        E = mp.expm(G * (end - begin))
        z = E[:n, :n] * z
        for s, left in enumerate(lefts):
            if s == 0 or middle > lefts[0] - left:
                z[:, n + s] += E[:n, n]
    rows = [[z[i, j] for j in range(size)] for i in range(n)]
    rows[n - 1][n - 1] -= 1
    if drive.speed is None:
        return dict(zip((*drive.states, DELTA), rows, strict=True))
    L = matrix(drive.speed, loads[-1][1], drive.inverse, (1, n + 1))
    speed = L[:, :n] * z
    for s in range(len(lefts)):
        speed[0, n + s] += L[0, n] * come[s]
    every = ([speed[0, j] for j in range(size)], *rows)
    return {n: [mp.mpf(0), *r] for n, r in zip((*drive.states, DELTA), every, strict=True)}


def draw_rows(rng, drive, timing, touched):
    """Return what a drive of the ranges does in some period."""
    spans = [timing.steps, *(timing.time_left(age) for age in timing.new_ages)]
    values = {s: inside(rng, interval) for s, interval in drive.ranges.items()}
    values |= {s: inside(rng, touched.get(s, KNOWN(F(0)))) for s in LOAD}
    period, *lefts = (inside(rng, span) for span in spans)
    lefts = [period, *(min(left, period) for left in lefts)]
    come = [True] * len(lefts)
    for s, span in enumerate(spans[1:], 1):
        if span.low == 0 and (lefts[s] == 0 or rng.random() < 0.3):
            lefts[s], come[s] = mp.mpf(0), rng.random() < 0.3
    shares = [rng.random() for _ in range(rng.randint(1, 4))]
    tissue = touched | {s: i for s, i in drive.ranges.items() if s in MEMORY}
    changing = {s: interval for s, interval in tissue.items() if interval.varies}
    loads = [
        (mp.mpf(share) / sum(shares), values | {s: inside(rng, i) for s, i in changing.items()})
        for share in shares
    ]
    return true_rows(drive, lefts, come, loads)


def far(points, rows):
    """Return how far rows are from the hull of points, in shares of the points' spread.

    What has no spread is exact.
    """
    places = [(name, j) for name, row in rows.items() for j in range(len(row))]
    A, b = [], []
    for name, j in places:
        column = [point.rows[name][j] for point in points]
        low, spread = min(column), max(column) - min(column)
        gap = rows[name][j] - mp.mpf(low.numerator) / low.denominator
        if spread:
            A.append([float((value - low) / spread) for value in column])
            b.append(float(gap * spread.denominator / spread.numerator))
        elif abs(gap) > mp.mpf(10) ** -40 * (1 + abs(rows[name][j])):
            return float("inf")
    return outside(np.array(A), b) if A else 0.0


SLOW = pytest.param(range(40, 150), marks=pytest.mark.slow)
NIGHTLY = pytest.param(range(150, 3000), marks=pytest.mark.nightly)


@pytest.mark.parametrize("seeds", [range(40), SLOW, NIGHTLY], ids=str)
def test_every_period_is_between_the_points(seeds):
    with mp.workdps(60):
        for seed in seeds:
            rng = random.Random(seed)
            drive, timing, touched = draw(rng)
            points = HeldDrive(drive, timing).flow(touched)
            for _ in range(5):
                rows = draw_rows(rng, drive, timing, touched)
                assert far(points, rows) < 1e-7, (seed, drive, timing, touched)


TORQUE = torque_drive(KNOWN(F(1, 5)), KNOWN(F(1, 2)))
TOUCHED = {"k": Interval(F(40), F(20), F(60)), "b": Interval(F(1, 10), F(0), F(1, 5))}
# A period of a drive at the ends of its ranges, and a number beyond one of them by a hundredth.
BEYOND = {
    "motor": (motor_drive(KNOWN(F(1)), Interval(F(3), F(2, 100), F(4, 100))), AIR, "tau", 1.01),
    "gain": (motor_drive(Interval(F(3), F(2), F(4)), KNOWN(F(1, 30))), AIR, "Km", 1.01),
    "lag": (lagging_drive(Interval(F(3), F(2, 100), F(4, 100))), AIR, "tau", 1.01),
    "torque": (torque_drive(Interval(F(1), F(1, 5), F(3, 10)), KNOWN(F(1))), AIR, "J", 1.01),
    "load": (TORQUE, TOUCHED, "k", 1.01),
}


@pytest.mark.parametrize("name", BEYOND)
def test_what_is_a_hundredth_beyond_a_range_is_beyond_the_points(name):
    drive, touched, symbol, beyond = BEYOND[name]
    points = HeldDrive(drive, CommandTiming(T)).flow(touched)
    highest = {**drive.ranges, **{s: touched.get(s, KNOWN(F(0))) for s in LOAD}}
    with mp.workdps(60):
        values = {s: mp.mpf(i.high.numerator) / i.high.denominator for s, i in highest.items()}
        period = [mp.mpf(T.numerator) / T.denominator]
        assert far(points, true_rows(drive, period, [True], [(1, values)])) < 1e-7
        values[symbol] *= beyond
        assert far(points, true_rows(drive, period, [True], [(1, values)])) > 1e-4


SHAKEN = CommandTiming(T, jitter=T / 5)


@pytest.mark.parametrize("name", DRIVES)
def test_what_is_known_is_near_one_point(name):
    """Also entries that others give, of drives of every kind, and with what they touch."""
    drive, touched = DRIVES[name], {"k": KNOWN(F(40)), "b": KNOWN(F(1, 4))}
    points = HeldDrive(drive, CommandTiming(T, T / 3, T / 3)).flow(touched)
    with mp.workdps(60):
        known = {**drive.ranges, **touched}
        values = {s: mp.mpf(i.low.numerator) / i.low.denominator for s, i in known.items()}
        period = mp.mpf(T.numerator) / T.denominator
        rows = true_rows(drive, [period, period * 2 / 3], [True, True], [(1, values)])
        assert far(points, rows) < 1e-7
        for point in points:
            for state, row in rows.items():
                found = [mp.mpf(x.numerator) / x.denominator for x in point.rows[state]]
                size = max(map(abs, row))
                assert max(abs(a - b) for a, b in zip(found, row, strict=True)) < 1e-9 * size


ONE_RANGE = {
    "memory": (
        DRIVES["motor"].remembering("d", [TOUCHED["k"], KNOWN(F(9))]),
        CommandTiming(T),
        AIR,
    ),
    "load": (TORQUE, CommandTiming(T), TOUCHED | {"b": KNOWN(F(0))}),
    "motor, jitter": (DRIVES["motor"], CommandTiming(T, jitter=T / 5), AIR),
    "velocity, jitter": (DRIVES["velocity"], CommandTiming(T, jitter=T / 5), AIR),
    "late lag": (DRIVES["lag"], CommandTiming(T, F(0), T / 2), AIR),
    "lag, late lag": (BEYOND["lag"][0], CommandTiming(T, T / 3, T / 3), AIR),
    "load, late": (DRIVES["loaded"], CommandTiming(T, T / 3, T * 3 / 2), TOUCHED),
}


@pytest.mark.parametrize("name", ONE_RANGE)
def test_a_range_at_a_time(name):
    """What changes within a period is on no curve; what lasts needs a period that is known."""
    drive, timing, touched = ONE_RANGE[name]
    points, rng = HeldDrive(drive, timing).flow(touched), random.Random(0)
    with mp.workdps(60):
        for _ in range(20):
            assert far(points, draw_rows(rng, drive, timing, touched)) < 1e-7


NARROW = {
    "torque": torque_drive(Interval(F(1), F(1), F("1.001")), Interval(F(2), F(2), F("2.001"))),
    "motor": motor_drive(KNOWN(F(1)), Interval(F(1), F(1, 31), F(1, 30))),
}


def middles(drive, lengths, loads):
    known = {s: (i.low + i.high) / 2 for s, i in drive.ranges.items()}
    for s in drive.inverse & known.keys():
        known[s] = 2 / (1 / drive.ranges[s].low + 1 / drive.ranges[s].high)
    exact = [
        {s: mp.mpf(v.numerator) / v.denominator for s, v in (known | load).items()}
        for load in loads
    ]
    period = mp.mpf(sum(lengths).numerator) / sum(lengths).denominator / 2
    return true_rows(drive, [period], [True], [(mp.mpf(1) / len(loads), v) for v in exact])


@pytest.mark.parametrize("name", NARROW)
def test_what_bends_is_just_inside_halfway(name, monkeypatch):
    """Where the second derivative hardly changes, that is as far as what interpolates is off."""
    monkeypatch.setattr(hull, "RANGED_BITS", 40)
    drive, still = NARROW[name], {"k": F(0), "b": F(0)}
    timing = CommandTiming(T, jitter=T / 2**10)
    points = HeldDrive(drive, timing).flow()
    with mp.workdps(60):
        ends = T - T / 2**10, T + T / 2**10
        assert far(points, middles(drive, ends, [still])) < 1e-9


@pytest.mark.parametrize("order", [1, -1])
def test_a_load_that_jumps_halfway_is_just_inside(order, monkeypatch):
    """Of all that has the same mean, it is off the most."""
    monkeypatch.setattr(hull, "RANGED_BITS", 40)
    short, k = F(1, 2000), Interval(F(5000), F(0), F(10_000))
    drive = torque_drive(KNOWN(F(1)), KNOWN(F(1)))
    points = HeldDrive(drive, CommandTiming(short)).flow({"k": k, "b": KNOWN(F(0))})
    loads = [{"k": end, "b": F(0)} for end in (k.low, k.high)[::order]]
    with mp.workdps(60):
        assert far(points, middles(drive, (short, short), loads)) < 1e-9


COUNTS = {
    "known motor": (motor_drive(KNOWN(F(2)), KNOWN(F(1, 30))), CommandTiming(T), AIR, 2),
    "motor": (BEYOND["motor"][0], CommandTiming(T), AIR, 3),
    "motor and its gain": (motor_drive(TOUCHED["k"], KNOWN(F(1, 30))), CommandTiming(T), AIR, 4),
    "late motor": (BEYOND["motor"][0], CommandTiming(T, T / 3, T / 3), AIR, 5),
    "known lag": (lagging_drive(KNOWN(F(1, 30))), CommandTiming(T), AIR, 2),
    "lag": (BEYOND["lag"][0], CommandTiming(T), AIR, 3),
    "second order": (position_drive(SECOND), CommandTiming(T), AIR, 3),
    "third order, jitter": (position_drive(THIRD), SHAKEN, AIR, 20),
    "fourth order, jitter": (position_drive(FOURTH), SHAKEN, AIR, 2 * 17),
    "torque in the air": (TORQUE, CommandTiming(T), AIR, 2),
    "torque": (TORQUE, CommandTiming(T), TOUCHED, 4 * 7),
}


@pytest.mark.parametrize("name", COUNTS)
def test_there_are_few_points(name):
    """A simplex around a curve, and a point more than entries that are off at each corner."""
    drive, timing, touched, count = COUNTS[name]
    assert len(HeldDrive(drive, timing).flow(touched)) == count


@pytest.mark.parametrize("name", [name for name in COUNTS if "known" in name])
def test_a_drive_that_is_known_is_one_number_in_doubles(name):
    drive, timing, touched, _ = COUNTS[name]
    points = HeldDrive(drive, timing).flow(touched)
    for state, row in points[0].rows.items():
        for j, first in enumerate(row):
            assert all(abs(p.rows[state][j] - first) * 2**55 <= abs(first) for p in points)


def test_no_corner_is_far_from_a_motor():
    """So what is refuted there is hardly refuted wrongly: a share of T - s, the way of the motor.

    The corner of a box, at the E of the fastest and the s of the slowest, is 18 % off at 2 ms.
    """
    tau = Interval(F("0.0351"), F("0.0351") * F(9, 10), F("0.0351") * F(11, 10))
    for point in HeldDrive(motor_drive(KNOWN(F(1)), tau), CommandTiming(T)).flow():
        E, s = (float(point.rows[name][0]) for name in ("omega [rad/s]", DELTA))
        motor = float(T) * (1 - E) / -np.log(E)
        assert abs(s - motor) <= 0.002 * (float(T) - motor)


def test_points_of_a_curve_are_those_of_its_number():
    """Of a constant number they are the corners; beside others, its ends are."""
    motor, timing = BEYOND["motor"][0], CommandTiming(T)
    assert [p.curve for p in HeldDrive(motor, timing).flow()] == [("tau", k) for k in range(3)]
    shaken = HeldDrive(motor, replace(timing, jitter=T / 5)).flow()
    assert {p.curve for p in shaken} == {None}
    assert {p.labels[:2] for p in shaken} == {
        (f"tau-{a}", f"T-{b}") for a in ("min", "max") for b in ("min", "max")
    }


def test_labels_tell_a_load_that_is_felt_again():
    points = HeldDrive(TORQUE, CommandTiming(T)).flow(TOUCHED, HELD_LOAD)
    assert {p.labels[0] for p in points} == {"k held-min", "k held-max"}


def test_a_simplex_holds_its_box():
    points = enclose_box({0: F(0), 1: F(5, 2), 2: F(5)}, {0: F(1), 1: F(1, 2), 2: F(0)})
    assert points == [{0: -1, 1: 2, 2: 5}, {0: 3, 1: 2, 2: 5}, {0: -1, 1: 4, 2: 5}]
    # The far corner of the box is halfway between the two far points.
    assert [(points[1][s] + points[2][s]) / 2 for s in range(3)] == [1, 3, 5]


def test_a_period_that_is_too_long_for_its_ranges_is_refused():
    wide = torque_drive(Interval(F(1), F(1, 10**6), F(10**6)), Interval.point(F(1)))
    with pytest.raises(AssemblyError, match="a period is too long"):
        HeldDrive(wide, CommandTiming(F(10**5))).flow({"k": Interval.point(F(10**9))})


@pytest.mark.parametrize("changing", [set(), {"k"}, {"b"}, {"k", "b"}])
def test_what_is_constant_does_not_change_within_a_period(changing):
    """It adds nothing to the change of what is not."""

    def width(touched):
        points = [p.rows[DELTA][0] for p in HeldDrive(TORQUE, CommandTiming(T)).flow(touched)]
        return max(points) - min(points)

    some, none, every = (
        width({s: replace(i, varies=s in which) for s, i in TOUCHED.items()})
        for which in (changing, set(), set(LOAD))
    )
    assert none <= some <= every
    assert (some == none) is (not changing)
    assert (some == every) is (changing == {"k", "b"})


@pytest.mark.parametrize(
    ("contacts", "lost", "constant"), [(1, False, True), (1, True, False), (2, False, False)]
)
def test_a_contact_is_constant_where_nothing_else_is_touched(contacts, lost, constant):
    interval = Interval(F(40), F(20), F(60), varies=False)
    each = [Environment(str(i), Elastic, (interval,)) for i in range(contacts)]
    assert anything_of(each, losable=lost)["k"].is_constant is constant


def test_free_motion_is_the_same_wherever_it_is():
    """No state but the deflection sees it: a robot in the air has no place."""
    law = Admittance.discrete(F(65, 100), F(16, 100), T)
    for drive, takes in (
        (position_drive(SECOND), CommandInterface.POSITION),
        (lagging_drive(Interval(F(3, 100), F(1, 50), F(1, 25))), CommandInterface.POSITION),
        (velocity_drive(ZEROED), CommandInterface.VELOCITY),
    ):
        timing = CommandTiming(T, T / 3, F(4, 3) * T)
        frame = Frame(timing, drive, StepFrame(F(0), F(0), interface=takes), (law,), 1)
        n = len(frame.states)
        rows = frame.rows(law, 1, {})[:n]
        assert [row[n - 1] for row in rows] == [*(0,) * (n - 1), 1]
