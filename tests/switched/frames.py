"""Frames of loops whose commands take effect at once, with a motor that is known."""

from fractions import Fraction

from nrs_design.models.actuator import Actuator, ActuatorRanges
from nrs_design.switched.command_timing import CommandTiming
from nrs_design.switched.held_motor import hold
from nrs_design.switched.sampled_frame import Frame


def frame_of(period, step, laws, delay, tau, *others, **named):
    timing = CommandTiming(Fraction(period))
    motor = hold(ActuatorRanges.point(Actuator(Fraction(1, 2000), Fraction(tau))), timing)
    return Frame(timing, motor, step, laws, delay, *others, **named)
