"""Drives over a period: enclosures, and loops by hand."""

from dataclasses import replace
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import expm

from nrs_design.controllers.laws import Admittance
from nrs_design.controllers.step_law import StepFrame
from nrs_design.errors import AssemblyError
from nrs_design.loop.command_timing import CommandTiming
from nrs_design.loop.held_drive import HeldDrive
from nrs_design.loop.held_motor import WAY, Commands
from nrs_design.loop.parameter_box import Box, around
from nrs_design.loop.sampled_modes import anything_of
from nrs_design.models.contact.elastic import Elastic
from nrs_design.models.contact.environment import Environment
from nrs_design.models.drive import (
    Takes,
    lagging_drive,
    loaded_motor,
    position_drive,
    torque_drive,
    velocity_drive,
)
from nrs_design.models.interval import Interval
from nrs_design.models.motion_loop import MotionLoop
from tests.loop.frames import Frame

F = Fraction
T = F(1, 500)
SECOND = MotionLoop((F(900),), (F(1), F(60), F(900)))
ZEROED = MotionLoop((F(28), F(1619)), (F(1), F(57), F(1619)))
TORQUE = torque_drive(Interval(F(1, 5), F(3, 20), F(3, 10)), Interval(F(1, 2), F(2, 5), F(3, 5)))
MOTOR = loaded_motor(
    Interval(F(1), F(9, 10), F(11, 10)), Interval(F(3, 100), F(1, 50), F(1, 25)), F(1, 5)
)
TOUCHED = {"k": Interval(F(40), F(20), F(60)), "b": Interval(F(1, 10), F(0), F(1, 5))}
CONSTANT = {s: replace(interval, varies=False) for s, interval in TOUCHED.items()}
DRIVES = {
    "velocity": (velocity_drive(ZEROED), None),
    "position": (position_drive(SECOND), None),
    "jumping position": (position_drive(ZEROED), None),
    "lag": (lagging_drive(Interval(F(3, 100), F(1, 50), F(1, 25))), None),
    "torque": (TORQUE, TOUCHED),
    "torque, constant load": (TORQUE, CONSTANT),
    "torque in the air": (TORQUE, None),
    "loaded motor": (MOTOR, TOUCHED),
}


def true_map(drive, values, pieces):
    """What the states after are of the states, the deflection, and the commands of the pieces."""
    n = drive.order
    rates = sum(
        float(np.prod([values[s] for s in symbols])) * np.array(rows, float)
        for symbols, rows in drive.rates.terms.items()
    )
    G = np.zeros((n + 1, n + 1))
    G[:n] = rates
    commands = len(pieces)
    z = np.hstack([np.eye(n), np.zeros((n, commands))])
    for i, length in enumerate(pieces):
        E = expm(G * length)
        z = E[:n, :n] @ z
        z[:, n + i] += E[:n, n]
    if drive.speed is not None:
        L = sum(
            float(np.prod([values[s] for s in symbols])) * np.array(rows, float)
            for symbols, rows in drive.speed.terms.items()
        )[0]
        speed = L[:n] @ z
        speed[n + commands - 1] += L[n]
        z = np.vstack([speed, z])
    return z


def forms(held, values, changes):
    """The results of a held drive over states, deflection, and commands: not of their changes."""
    drive = held.drive
    n, jumps = drive.order, drive.speed is not None
    size = n + 1 + changes
    unit = [[F(int(i == j)) for j in range(size)] for i in range(size)]
    states = (*([[F(0)] * size] if jumps else []), *unit[: n - 1])
    given = Commands(tuple(states), unit[n - 1], unit[n], tuple(unit[n + 1 :]))
    rows = np.array([held.result(name, given, values) for name in (*held.states, WAY)], float)
    rows[-1, n - 1] += 1
    # A command lasts from its change to the next.
    for i in range(changes):
        rows[:, n + i] -= rows[:, n + i + 1]
    return rows


@settings(max_examples=60)
@given(st.sampled_from(sorted(DRIVES)), st.lists(st.fractions(0, 1), min_size=6, max_size=6))
def test_every_drive_is_within_what_encloses_it(name, at):
    """Anywhere in the ranges; interpolated, it is off by no more than is said."""
    drive, touched = DRIVES[name]
    timing = CommandTiming(T, T / 4, T / 2)
    held = HeldDrive.of(drive, timing, touched)
    share = iter(at)

    def inside(interval):
        return interval.low + next(share) * (interval.high - interval.low)

    values = {
        symbol: inside(interval) for symbol, interval in held.numbers.items() if symbol != "T"
    }
    time = values["h0"]
    true = {s: float(1 / v if s in drive.inverse else v) for s, v in values.items()}
    wanted = true_map(drive, {"k": 0.0, "b": 0.0} | true, [float(T - time), float(time)])
    found = forms(held, values, 1)
    off = np.zeros_like(found)
    n = drive.order
    for (span, row, column), entry in held.entries.items():
        i = n if row == n else row + (drive.speed is not None)
        i = 0 if drive.speed is not None and row == n else i
        if span == 0:
            off[i, column] += float(entry.off)
            if column == n and drive.takes is Takes.POSITION:
                off[i, n - 1] += float(entry.off)
        else:
            off[i, n] += float(entry.off)
            off[i, n + 1] += float(entry.off)
    off[:, n + 1] += off[:, n]
    assert (abs(found - wanted) <= off + 1e-12 * (1 + abs(wanted))).all()
    # It is of second order in the ranges.
    assert off.max() < 0.05 * max(1.0, abs(wanted).max())


@pytest.mark.parametrize("name", sorted(DRIVES))
def test_a_drive_that_is_known_is_enclosed_to_one_number_in_doubles(name):
    drive, touched = DRIVES[name]
    known = None if touched is None else {s: Interval.point(i.low) for s, i in touched.items()}
    held = HeldDrive.of(drive.at({}), CommandTiming(T), known)
    assert not held.box.ranges
    for entry in held.entries.values():
        (value,) = entry.corners.values()
        assert entry.off <= abs(value) * F(1, 2**60)


def test_a_simplex_holds_its_box():
    ranges = {
        "x": Interval(F(0), F(-1), F(1)),
        "y": Interval(F(0), F(2), F(3)),
        "z": Interval.point(F(5)),
    }
    points = around(ranges)
    assert points == (
        {"x": -1, "y": 2, "z": 5},
        {"x": 3, "y": 2, "z": 5},
        {"x": -1, "y": 4, "z": 5},
    )
    # The far corner of the box is halfway between the two far points.
    assert [(points[1][s] + points[2][s]) / 2 for s in "xyz"] == [1, 3, 5]


def test_what_is_not_affine_together_is_refused():
    """A product of two numbers of a hull is the mean of nothing."""
    box = Box({}, hull=around({"x": Interval(F(0), F(0), F(1)), "y": Interval(F(0), F(0), F(1))}))
    assert len(list(box.corners(lambda v: [[v["x"] + 2 * v["y"]]], "plain"))) == 3
    with pytest.raises(Exception, match="not affine"):
        list(box.corners(lambda v: [[v["x"] * v["y"]]], "bent"))


def test_a_period_that_is_too_long_for_its_ranges_is_refused():
    wide = torque_drive(Interval(F(1), F(1, 10**6), F(10**6)), Interval.point(F(1)))
    with pytest.raises(AssemblyError, match="a period is too long"):
        HeldDrive.of(wide, CommandTiming(F(10**5)), {"k": Interval.point(F(10**9))})


def floats_of(frame, law, delay=0, **values):
    n = len(frame.states)
    held = dict.fromkeys(frame.motor.box.hull[0], F(0))
    rows = frame.rows(law, delay, held | values)[:n]
    return np.array([[float(v) for v in row[:n]] for row in rows])


@pytest.mark.parametrize("inert", [True, False])
@pytest.mark.parametrize("late", [F(0), T / 3, F(3, 2) * T])
@pytest.mark.parametrize("loop", [SECOND, ZEROED])
def test_a_streamed_position_moves_as_by_hand(inert, late, loop):
    """The reference is sent once it has moved on; what is felt is the contact of the sample."""
    a, b, k, step = 0.65, 0.16, 43.0, float(T)
    law = Admittance.discrete(F(a) if inert else None, F(b), F(step))
    timing = CommandTiming(T, late, late)
    drive = position_drive(loop)
    motor = HeldDrive.of(drive, timing)
    frame = Frame(timing, motor, StepFrame(F(0), F(0), takes=Takes.POSITION), (law,), 0)
    n = drive.order
    (rates,) = drive.rates.terms.values()
    G = np.zeros((n + 1, n + 1))
    G[:n] = np.array(rates, float)
    rng = np.random.default_rng(3)
    own, theta, reference, vm = rng.normal(size=n - 1), *rng.normal(size=3)
    sent = rng.normal(size=3)
    jumps = drive.speed is not None
    names = [*frame.motor.states[jumps:]]
    x = dict.fromkeys(frame.states, 0.0) | dict(zip(names, own, strict=True))
    x |= {"delta [rad]": theta, "e [rad]": reference - theta, "vm [rad/s]": vm}
    x |= {f"u {i} before": u - theta for i, u in enumerate(sent, 1)}
    force = k * theta
    velocity = a * vm + b * force if inert else b * force
    moved = reference - step * (vm if inert else velocity)
    every = [moved, *sent]
    whole = int(late // T)
    part = float(late - whole * T)
    z = np.array([*own, theta, every[whole + (part > 0)]])
    z = expm(G * part) @ z
    z[-1] = every[whole]
    z = expm(G * (step - part)) @ z
    after = dict(
        zip(
            frame.states,
            floats_of(frame, law, k=F(43)) @ [x[name] for name in frame.states],
            strict=True,
        )
    )
    assert after["delta [rad]"] == pytest.approx(z[-2], rel=1e-6, abs=1e-9)
    assert after["e [rad]"] == pytest.approx(moved - z[-2], rel=1e-6, abs=1e-9)
    assert [after[name] for name in names] == pytest.approx(z[: n - 1], rel=1e-6, abs=1e-7)
    if jumps:
        (speed,) = drive.speed.terms.values()
        assert after["omega [rad/s]"] == pytest.approx(np.array(speed[0], float) @ z, rel=1e-6)


def test_free_motion_is_the_same_wherever_it_is():
    """No state but the deflection sees it: a robot in the air has no place."""
    law = Admittance.discrete(F(65, 100), F(16, 100), T)
    for drive, takes in (
        (position_drive(SECOND), Takes.POSITION),
        (lagging_drive(Interval(F(3, 100), F(1, 50), F(1, 25))), Takes.POSITION),
        (velocity_drive(ZEROED), Takes.VELOCITY),
    ):
        timing = CommandTiming(T, T / 3, F(4, 3) * T)
        motor = HeldDrive.of(drive, timing)
        frame = Frame(timing, motor, StepFrame(F(0), F(0), takes=takes), (law,), 1)
        for _, values in motor.box.named_values("free"):
            n = len(frame.states)
            rows = frame.rows(law, 1, values)[:n]
            assert [row[n - 1] for row in rows] == [*(0,) * (n - 1), 1]


@settings(max_examples=40)
@given(
    st.lists(
        st.tuples(st.floats(0, 1), st.floats(0, 1), st.floats(0.05, 1)), min_size=2, max_size=5
    ),
    st.sampled_from([0.0, 0.3]),
)
def test_what_is_touched_may_change_within_a_period(pieces, late):
    """Contact that comes, goes and stiffens at any moment is a constant one of its mean, nearly."""
    T, J, B = 0.001, 0.15, 0.5
    drive = torque_drive(Interval.point(F("0.15")), Interval.point(F(1, 2)))
    touched = {"k": Interval(F(20), F(0), F(60)), "b": Interval(F(1, 10), F(0), F(1, 5))}
    timing = CommandTiming(F(1, 1000), F(late) * F(1, 1000), F(late) * F(1, 1000))
    held = HeldDrive.of(drive, timing, touched)
    lengths = np.array([piece[2] for piece in pieces])
    lengths *= T / lengths.sum()
    loads = [(60 * x, 0.2 * y) for x, y, _ in pieces]
    mean = {
        symbol: float(sum(load[i] * time for load, time in zip(loads, lengths, strict=True)) / T)
        for i, symbol in enumerate(("k", "b"))
    }
    cuts = sorted({0.0, late * T, *np.cumsum(lengths)[:-1], T})
    z = np.hstack([np.eye(2), np.zeros((2, 2))])
    for begin, end in pairwise(cuts):
        at = int(np.searchsorted(np.cumsum(lengths), (begin + end) / 2))
        k, b = loads[min(at, len(loads) - 1)]
        G = np.array([[-(B + b) / J, -k / J, 1 / J], [1, 0, 0], [0, 0, 0]])
        E = expm(G * (end - begin))
        z = E[:2, :2] @ z
        z[:, 2 + int(begin >= late * T and late > 0)] += E[:2, 2]
    changes = len(timing.within)
    found = forms(held, {symbol: F(value) for symbol, value in mean.items()}, changes)
    wanted = z if changes else z[:, :3]
    off = np.zeros_like(found)
    for (span, row, column), entry in held.entries.items():
        off[row, column + span] += float(entry.off)
        if span:
            off[row, 2] += float(entry.off)
    assert (abs(found - wanted) <= off + 1e-13).all()
    assert off.max() < 0.002


@pytest.mark.parametrize("changing", [set(), {"k"}, {"b"}, {"k", "b"}])
def test_what_is_constant_does_not_change_within_a_period(changing):
    """It adds nothing to the change of what is not."""

    def off(touched):
        held = HeldDrive.of(TORQUE, CommandTiming(T), touched)
        return {place: entry.off for place, entry in held.entries.items()}

    some = off({s: replace(i, varies=s in changing) for s, i in TOUCHED.items()})
    none, every = off(CONSTANT), off(TOUCHED)
    assert all(none[place] <= some[place] <= every[place] for place in every)
    assert (some == none) is (not changing)
    assert (some == every) is (changing == {"k", "b"})


@pytest.mark.parametrize(
    ("contacts", "lost", "constant"), [(1, False, True), (1, True, False), (2, False, False)]
)
def test_a_contact_is_constant_where_nothing_else_is_touched(contacts, lost, constant):
    interval = Interval(F(40), F(20), F(60), varies=False)
    each = [Environment(str(i), Elastic, (interval,)) for i in range(contacts)]
    assert anything_of(each, lost=lost)["k"].is_constant is constant


@pytest.mark.parametrize("late", [0.5, 1.0, 1.25, 1.5])
def test_a_velocity_has_not_jumped_before_its_command_takes_effect(late):
    """Of a robot with ``tau theta' = u - theta`` under commands half a period to 1.5 late."""
    tau, step = 0.01, float(T)
    timing = CommandTiming(T, T / 2, F(3, 2) * T)
    held = HeldDrive.of(lagging_drive(Interval.point(F(1, 100))), timing)
    theta, u0, u1, u2 = 0.3, 1.0, -2.0, 5.0
    # The last command but one comes half a period late, the newest after `late` periods.
    where = u1 + (theta - u1) * np.exp(-step / tau)
    speed = (u1 - where) / tau  # Between -200 and 500
    left = max(1 - late, 0.0)
    if late < 1:
        where = u1 + (theta - u1) * np.exp(-(1 - left) * step / tau)
        where = u2 + (where - u2) * np.exp(-left * step / tau)
        speed = (u2 - where) / tau
    values = {"h1": T, "h0": F(left) * T, "in0": F(int(late < 1))}
    assert {*held.numbers} >= {*values}
    found = forms(held, values, 2) @ [theta, u0, u1, u2]
    off = float(sum(entry.off for entry in held.entries.values()))
    assert found == pytest.approx([speed, where], abs=off * max(abs(u0 - u1), abs(u1 - u2)))
    assert off < 1
