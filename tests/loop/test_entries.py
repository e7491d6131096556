"""Entries of drives, their Taylor coefficients, and what a load that changes makes of them."""

from fractions import Fraction

import numpy as np
import pytest
from scipy.linalg import expm

from nrs_design.loop.entries import Entries, exact_rows, highest, lowest, middle
from nrs_design.models import drive as module
from nrs_design.models.interval import Interval
from nrs_design.models.motion_loop import MotionLoop
from nrs_design.proof.enclosure import ball_around, precision

F, H = Fraction, Fraction(1, 200)
SECOND = MotionLoop((F(900),), (F(1), F(60), F(900)))
JUMPS = MotionLoop((F(28), F(1619)), (F(1), F(57), F(1619)))
STILL = MotionLoop((F(1),), (F(1), F(0)))
NUMBERS = {"Km": F(1), "tau": F(1, 30), "J": F(1, 5), "B": F(1, 2), "k": F(40), "b": F(1, 4)}
NUMBERS |= {"r1": F(7), "r2": F(11)}
MOTOR = module.motor_drive(Interval.point(F(1)), Interval.point(F(1, 30)))
LOADED = module.motor_drive(Interval.point(F(1)), Interval.point(F(1, 30)), F(1, 5))
TORQUE = module.torque_drive(Interval.point(F(1, 5)), Interval.point(F(1, 2)))
LAG = module.lagging_drive(Interval.point(F(1, 30)))
DRIVES = {
    "motor": MOTOR,
    "loaded": LOADED,
    "torque": TORQUE,
    "lag": LAG,
    "position": module.position_drive(SECOND),
    "jumping": module.position_drive(JUMPS),
    "velocity": module.velocity_drive(SECOND),
    "integrator": module.velocity_drive(STILL),
}
DRIVES |= {
    f"{name}, remembering": drive.remembering("d", [Interval.point(F(1))] * len(module.MEMORY))
    for name, drive in DRIVES.items()
}
EVERY = pytest.mark.parametrize("drive", DRIVES.values(), ids=DRIVES)


def numbers(drive, **changes):
    """The numbers of a drive in the coordinates in which its rates are affine."""
    values = NUMBERS | changes
    return {s: 1 / v if s in drive.inverse else v for s, v in values.items()}


def entries(drive, h, **changes):
    """The entries in floating point: of the deflection, by how much it changes."""
    at, n = numbers(drive, **changes), drive.order
    G = np.array([*exact_rows(drive.rates, at), [0] * (n + 1)], float)
    E = expm(G * float(h))
    found = E[:n].copy()
    found[n - 1, n - 1] -= 1
    if drive.speed is not None:
        found = np.vstack([found, np.array(exact_rows(drive.speed, at), float) @ E])
    return found


def floats(M):
    return np.array([[float(M[i, j].mid()) for j in range(M.ncols())] for i in range(M.nrows())])


def jet(drive, by, width, order):
    at = {s: ball_around(v) for s, v in numbers(drive).items()}
    with precision(240):
        found = Entries(drive).jet(at, ball_around(H), by, ball_around(width), order)
        assert np.array_equal(floats(Entries(drive).evaluate(at, ball_around(H))), floats(found[0]))
        return [floats(M) for M in found]


@pytest.mark.parametrize(
    ("name", "by"),
    [(name, "") for name in DRIVES]
    + [("motor", "tau"), ("lag", "tau"), ("loaded", "k"), ("torque, remembering", "b")]
    + [("lag, remembering", "r2"), ("loaded, remembering", "r1")],
)
def test_coefficients_are_those_of_taylor(name, by):
    """Their sum is what the entries are at the other end of a range."""
    drive = DRIVES[name]
    at = numbers(drive)
    width = at[by] / 3 if by else H / 3
    end = at[by] + width if by else None
    changes = {by: 1 / end if by in drive.inverse else end} if by else {}
    wanted = entries(drive, H if by else H + width, **changes)
    coefficients = jet(drive, by, width, 10)
    assert sum(coefficients) == pytest.approx(wanted, rel=1e-9, abs=1e-12)


@EVERY
def test_what_acts_is_what_is_not_zero(drive):
    at = {s: ball_around(v) for s, v in numbers(drive).items()}
    acting = np.array(Entries(drive).acting(at))
    assert np.array_equal(acting, np.abs(entries(drive, H)) > 1e-13)


@pytest.mark.parametrize("name", ["loaded", "torque", "torque, remembering"])
def test_a_load_that_changes_is_off_by_the_bound_of_the_page(name):
    """``T^2/8`` times the slope of the kernel, and for the command the integral of two of them."""
    drive, widths = DRIVES[name], {"k": F(20), "b": F(1, 5)}
    at, m = {s: ball_around(v) for s, v in numbers(drive).items()}, drive.order + 1
    with precision(240):
        balls = {s: ball_around(w) for s, w in widths.items()}
        found = floats(Entries(drive).bound_change(at, ball_around(H), balls))
    known, T = numbers(drive), float(H)

    def sizes(rows):
        return np.abs(np.array([*rows, [0] * m], float))

    M = sizes(exact_rows(drive.rates, known))
    wanted = np.zeros((m, m))
    for symbol, width in widths.items():
        N = sizes(exact_rows(drive.rates.slope(symbol), known))
        states = expm(M * T) @ (N @ M + M @ N) @ expm(M * T) * float(width) * T**2 / 8
        both = expm(np.block([[M, N], [np.zeros((m, m)), M]]) * T)[:m, m:] * float(width)
        wanted += np.column_stack([states[:, :-1], both[:, -1]])
    assert found == pytest.approx(wanted, rel=1e-9)


@pytest.mark.parametrize("end", [highest, lowest, middle])
def test_what_is_beyond_all_numbers_has_no_ends(end):
    with pytest.raises(OverflowError):
        end(ball_around(F(1)) / ball_around(F(0)))
