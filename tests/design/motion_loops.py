"""Motion loops and contact of the published designs."""

from fractions import Fraction

from nrs_design.controllers.laws import ProportionalDerivative
from nrs_design.design.transfer import TransferFunction
from nrs_design.loop.cut_loop import ContinuousAxis, Place
from nrs_design.models.actuator import Actuator
from nrs_design.models.interval import Interval
from nrs_design.models.motion_loop import MotionLoop, realize

# Thesis 6.1 as printed, and with the exact coefficients of Kd = 2060, z = 56.9706.
PRINTED = TransferFunction((0.99, 56.82), (0.0351, 1.99, 56.82))
EXACT = TransferFunction((0.9974, 56.822), (0.0351, 1.9974, 56.822))
GAIN, TAU = 2060 * 4.8417e-4, 0.0351  # thesis 4.1 and 4.3
LOOP = TransferFunction((GAIN, GAIN * 56.9706), (TAU, 1 + GAIN, GAIN * 56.9706))
SOFT = 43.0356
PD = ProportionalDerivative(Fraction("117359.436"), Fraction(2060))
LAG = MotionLoop((Fraction(1),), (Fraction(1), Fraction(1)))
PLACE = Place(Actuator(Fraction("4.8417e-4"), Fraction("0.0351")))


def axis_with(motion: TransferFunction) -> ContinuousAxis:
    """The axis with this motion loop and nothing else."""
    loop = MotionLoop(
        tuple(map(Fraction, motion.numerator)), tuple(map(Fraction, motion.denominator))
    )
    return ContinuousAxis((PLACE,), realize(loop))


def interval(low, high):
    return Interval(Fraction(low), Fraction(low), Fraction(high))
