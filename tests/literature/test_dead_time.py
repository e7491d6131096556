"""A constant dead time of the drive: its border tends to the delay margin of the continuous loop.

Soft tissue of the thesis (6.3.1), Mt = 0.01, nominal motor and stiffness. The margin is that of
python-control for the loop cut where the dead time is: at the command of the motor, so that the PD
loop around it is late as well. Cut at the force sensor it is 51.2 ms and 10.7 ms: that is the
border for a robot that closes its own motion loop, the same G, and is late as a whole.
"""

from fractions import Fraction

import control
import numpy as np
import pytest

from nrs_design.controllers.laws import Admittance
from nrs_design.controllers.step_law import StepFrame
from nrs_design.loop.calendar import CommandTiming
from nrs_design.models.actuator import Actuator
from nrs_design.models.drive import CommandInterface, motor_drive, velocity_drive
from nrs_design.models.interval import Interval
from nrs_design.models.motion_loop import close_motion_loop
from tests.loop.frames import Frame

KM, TAU, KD = Fraction("4.8417e-4"), Fraction("0.0351"), Fraction(2060)
KP, MT = KD * Fraction("56.9706"), Fraction("0.01")
K = Fraction("747.1461") * Fraction("0.24") ** 2


def delay_margin(Bt, *, at_motor):
    """Return the delay margin in s, cut at the command of the motor or at the force."""
    s = control.tf("s")
    motor = float(KM) / (s * (float(TAU) * s + 1)) * (float(KP) + float(KD) * s)
    felt = float(K) / (s * (float(MT) * s + float(Bt)))
    loop = motor * (1 + felt) if at_motor else motor / (1 + motor) * felt
    _, phase, _, _, crossing, _ = control.stability_margins(control.minreal(loop, verbose=False))
    return np.radians(phase) / crossing


def held_in(timing, *, closed):
    """The motor, or a robot that closes the loop around it by itself and takes velocities."""
    if not closed:
        motor = motor_drive(Interval.point(KM), Interval.point(TAU))
        return motor, StepFrame(KP, KD / timing.period)
    drive = velocity_drive(close_motion_loop(Actuator(KM, TAU), KP, KD))
    step = StepFrame(Fraction(0), Fraction(0), interface=CommandInterface.VELOCITY)
    return drive, step


def border(Bt, T, *, closed=False):
    """Return the dead time from which on the sampled loop has an eigenvalue outside, by bisection.

    Everything but the eigenvalue is exact; the law is that of the period, not rounded.
    """
    a = Fraction(float(np.exp(-float(Bt * T / MT))))
    law = Admittance.discrete(a, (1 - a) / Bt, T)

    def is_stable(late):
        timing = CommandTiming(T, late, late)
        drive, step = held_in(timing, closed=closed)
        frame = Frame(timing, drive, step, (law,), 0)
        n = len(frame.states)
        rows = frame.rows(law, 0, {"k": K})[:n]
        A = np.array([[float(v) for v in row[:n]] for row in rows])
        return abs(np.linalg.eigvals(A)).max() < 1

    low, high = Fraction(0), Fraction(1, 10)
    while high - low > Fraction(1, 10**5):
        middle = (low + high) / 2
        low, high = (middle, high) if is_stable(middle) else (low, middle)
    return float(low)


@pytest.mark.parametrize(
    ("Bt", "margin", "closed", "least"),
    [
        (Fraction("2.15"), 0.01838, False, 0.3),
        (Fraction("1.04"), 0.00769, False, 0.3),
        (Fraction("2.15"), 0.0512, True, -0.1),
        (Fraction("1.04"), 0.01066, True, -0.1),
    ],
)
def test_the_border_of_a_dead_time_tends_to_the_delay_margin(Bt, margin, closed, least):
    """It is short by about a period, which holding commands and forces takes, and a half."""
    assert delay_margin(Bt, at_motor=not closed) == pytest.approx(margin, rel=1e-3)
    periods = Fraction(1, 500), Fraction(1, 2000)
    missing = [margin - border(Bt, T, closed=closed) for T in periods]
    for short, T in zip(missing, map(float, periods), strict=True):
        assert least * T < short < 2.5 * T
    assert missing[1] < 0.35 * missing[0]
