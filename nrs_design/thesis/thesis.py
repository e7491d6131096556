"""Input numbers of the thesis: measured, chosen, or from data sheets."""

from __future__ import annotations

import math
from fractions import Fraction

from nrs_design.design.loop_family import LoopFamily
from nrs_design.design.transfer import TransferFunction
from nrs_design.loop.cut_loop import ContinuousAxis, Place
from nrs_design.models.actuator import Actuator
from nrs_design.models.contact import Elastic
from nrs_design.models.motion_loop import MotionLoop, close_motion_loop, realize

# Thesis 4.1: table 4.1, gearhead 181:1, break frequency and low-frequency gain of figure 4.3.
MOTOR_INERTIA, GEARHEAD_INERTIA = 14.5e-7, 0.31e-7
BREAK_FREQUENCY = 28.4767
GAIN_IN_DECIBEL = -66.3
ACTUATOR = Actuator(gain=Fraction("4.8417e-4"), time_constant=Fraction("0.0351"))

# Thesis 4.14, 4.29 and 4.30.
DAMPING_RATIO = 0.707
SETTLING_TIME = 0.1404
DERIVATIVE_GAIN, ZERO = Fraction(2060), Fraction("56.9706")

# Thesis 6.3.1.1 and 6.4.1: largest torque and speed, band, specimens, lever arm.
TORQUE = 0.3
VELOCITY = math.radians(8)
DESIRED = TORQUE / VELOCITY
BANDWIDTH_IN_HERTZ = 2
SOFT = Fraction("747.1461") * Fraction("0.24") ** 2
STIFF = Fraction("1070.5") * Fraction("0.24") ** 2

# Thesis 6.1 as printed, and with all digits of the loop that 4.29 and 4.30 give.
PRINTED_LOOP = TransferFunction((0.99, 56.82), (0.0351, 1.99, 56.82))
CLOSED_LOOP = close_motion_loop(ACTUATOR, Kp=DERIVATIVE_GAIN * ZERO, Kd=DERIVATIVE_GAIN)
EXACT_LOOP = TransferFunction(
    tuple(map(float, CLOSED_LOOP.numerator)), tuple(map(float, CLOSED_LOOP.denominator))
)

AXIS = ContinuousAxis((Place(ACTUATOR),), realize(CLOSED_LOOP))

# Thesis 6.13 and 6.14: the realization with the digits of the print.
REALIZED_LOOP = MotionLoop(
    numerator=(Fraction("28.4160"), Fraction("1618.80")),
    denominator=(Fraction(1), Fraction("56.89"), Fraction("1618.80")),
)

# Thesis 6.3.3.1, in rad/(N m).
FORCE_GAIN = Fraction("0.02")


def stiffness_limit(Mt: float, Bt: float) -> float:
    """Return the largest stable stiffness of an elastic contact in N m/rad."""
    # Any stiffness will do: the limit does not hang on it.
    return LoopFamily(AXIS, Elastic(SOFT), Fraction(0), AXIS.places[0]).stiffness_limit(Mt, Bt)
