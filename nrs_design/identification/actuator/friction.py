"""Coulomb friction in time: which way it acts, and where the motor sticks."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from nrs_design.identification.held import Held
from nrs_design.models.recursion import run_first_order

Array = NDArray[np.float64]

# Intervals that are solved at once, as long as the motor does not turn; then twice as many.
_AHEAD = 32


def friction_shape(held: Held, gain: float, tau: float, friction: float) -> Array:
    """Return friction over its largest value, the mean over each interval, shape (m - 1,).

    It is 1 or -1 against the motion. Where the velocity reaches zero while the command is below
    the friction, the motor sticks, and the friction is just the command. A reversal within an
    interval is found exactly. Starts from rest.

    Parameters
    ----------
    held : Held
        The command as it acts.
    gain : float
        In rad/s for each unit of the command.
    tau : float
        Time constant in s.
    friction : float
        In units of the command.
    """
    decays = np.exp(-held.steps / tau)
    command, steps = held.command, held.steps
    shape = np.empty(len(steps))
    velocity, at, ahead = 0.0, 0, _AHEAD
    while at < len(steps):
        if velocity == 0.0 and abs(command[at]) <= friction:
            until = _next(np.abs(command[at : at + ahead]) > friction, at)
            shape[at:until] = command[at:until] / friction
            at, ahead = until, 2 * ahead
            continue
        direction = math.copysign(1.0, velocity or float(command[at]))
        part = slice(at, at + ahead)
        inputs = (1 - decays[part]) * gain * (command[part] - friction * direction)
        inputs[0] += decays[at] * velocity
        course = run_first_order(decays[part], inputs)[1:]
        until = _next(course * direction < 0.0, at)
        shape[at:until] = direction
        before = float(course[until - at - 1]) if until > at else velocity
        if until == min(at + ahead, len(steps)):
            velocity, at, ahead = before, until, 2 * ahead
            continue
        value, step = float(command[until]), float(steps[until])
        target = gain * (value - friction * direction)
        stop = -tau * math.log(target / (target - before))
        if abs(value) <= friction:
            velocity, after = 0.0, value / friction
        else:
            turned = gain * (value + friction * direction)
            velocity, after = turned * -math.expm1((stop - step) / tau), -direction
        shape[until] = (stop * direction + (step - stop) * after) / step
        at, ahead = until + 1, _AHEAD
    return shape


def _next(flags: NDArray[np.bool_], at: int) -> int:
    """Return the index of the first true flag, counted from ``at``; the end if there is none."""
    first = int(np.argmax(flags))
    return at + (first if flags[first] else len(flags))
