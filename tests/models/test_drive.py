"""Drives: their transfer functions, and where they rest."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.errors import AssemblyError
from nrs_design.models.drive import lagging_drive, position_drive, torque_drive, velocity_drive
from nrs_design.models.interval import Interval
from nrs_design.models.motion_loop import MotionLoop

F = Fraction
COEFFICIENT = st.integers(1, 50).map(F)


def rows_of(M, values):
    """A matrix in floating point, at numbers by symbol."""
    return sum(
        np.prod([values[s] for s in symbols]) * np.array(rows, float)
        for symbols, rows in M.terms.items()
    )


def response(drive, s, values=None):
    """Angle and velocity over the command at a complex frequency."""
    known = values or {}
    n = drive.order
    M = rows_of(drive.rates, known)
    A, B = M[:, :n], M[:, n]
    z = np.linalg.solve(s * np.eye(n) - A, B)
    speed = z[0]
    if drive.speed is not None:
        L = rows_of(drive.speed, known)[0]
        speed = L[:n] @ z + L[n]
    return z[-1], speed


@given(
    st.lists(COEFFICIENT, min_size=1, max_size=3),
    st.lists(COEFFICIENT, min_size=4, max_size=5),
    st.complex_numbers(min_magnitude=0.5, max_magnitude=20),
)
def test_a_streamed_velocity_goes_through_its_transfer_function(numerator, denominator, s):
    G = np.polyval(np.array(numerator, float), s) / np.polyval(np.array(denominator, float), s)
    angle, speed = response(velocity_drive(MotionLoop(tuple(numerator), tuple(denominator))), s)
    scale = abs(np.polyval(np.array(numerator, float), abs(s)))
    if abs(np.polyval(np.array(denominator, float), s)) > 1e-3:
        assert speed == pytest.approx(G, rel=1e-7, abs=1e-9 * scale)
        assert angle == pytest.approx(G / s, rel=1e-7, abs=1e-9 * scale)


@given(
    st.lists(COEFFICIENT, min_size=0, max_size=2),
    st.lists(COEFFICIENT, min_size=2, max_size=4),
    COEFFICIENT,
    st.complex_numbers(min_magnitude=0.5, max_magnitude=20),
)
def test_a_streamed_position_does_and_rests_where_it_is_sent(numerator, denominator, last, s):
    """At rest all its states but the deflection are zero, wherever that is."""
    numerator = [*numerator[: len(denominator) - 1], last]
    denominator = [*denominator, last]
    loop = MotionLoop(tuple(numerator), tuple(denominator))
    drive = position_drive(loop)
    angle, speed = response(drive, s)
    D = np.polyval(np.array(denominator, float), s)
    if abs(D) > 1e-3:
        G = np.polyval(np.array(numerator, float), s) / D
        assert angle == pytest.approx(G, rel=1e-6, abs=1e-8)
        assert speed == pytest.approx(s * G, rel=1e-6, abs=1e-8)
    (rates,) = drive.rates.terms.values()
    assert all(row[-2] == -row[-1] for row in rates)
    if drive.speed is None:
        # The second state is the velocity.
        assert rates[-1] == (1, *(0,) * (len(rates[-1]) - 1))
    else:
        assert len(numerator) == len(denominator) - 1


def test_the_lag_of_a_position_is_that_of_its_transfer_function():
    lag = lagging_drive(Interval.point(F(3, 100)))
    other = position_drive(MotionLoop((F(1),), (F(3, 100), F(1))))
    for s in (2j, 5 + 30j):
        np.testing.assert_allclose(response(lag, s, {"tau": 100 / 3}), response(other, s))
    assert lag.states == other.states == ("omega [rad/s]",)


def test_a_torque_moves_an_inertia_with_friction_and_what_it_touches():
    drive = torque_drive(Interval.point(F(1, 5)), Interval.point(F(1, 2)))
    J, B, k, b, s = 0.2, 0.5, 40.0, 0.3, 3j
    angle, speed = response(drive, s, {"J": 1 / J, "B": B, "k": k, "b": b})
    assert angle == pytest.approx(1 / (J * s**2 + (B + b) * s + k))
    assert speed == pytest.approx(s * angle)


def test_a_robot_that_rests_elsewhere_is_refused():
    with pytest.raises(AssemblyError, match="does not come to rest where it is commanded"):
        position_drive(MotionLoop((F(2),), (F(1), F(1))))


def test_ranges_are_stretched_and_stay_positive():
    drive = torque_drive(Interval(F(2), F(1), F(3)), Interval.point(F(1)))
    assert drive.scaled(F(1, 2)).ranges["J"] == Interval(F(2), F(3, 2), F(5, 2))
    assert drive.fix_values({"J": F(3)}).ranges["J"] == Interval.point(F(3))
    with pytest.raises(AssemblyError, match="does not stay physical"):
        drive.scaled(F(3))
