"""Coulomb friction in time: which way it acts, and where the motor sticks."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from nrs_design.identification.held import Held

Array = NDArray[np.float64]


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
    decays = np.exp(-held.steps / tau).tolist()
    velocity = 0.0
    shape: list[float] = []
    pairs = zip(held.command.tolist(), held.steps.tolist(), decays, strict=True)
    for command, step, decay in pairs:
        if velocity == 0.0 and abs(command) <= friction:
            shape.append(command / friction)
            continue
        direction = math.copysign(1.0, velocity or command)
        target = gain * (command - friction * direction)
        new = target + (velocity - target) * decay
        if new * velocity >= 0.0:
            velocity = new
            shape.append(direction)
            continue
        stop = -tau * math.log(target / (target - velocity))
        part = stop / step
        if abs(command) <= friction:
            velocity, after = 0.0, command / friction
        else:
            target = gain * (command + friction * direction)
            velocity, after = target * -math.expm1((stop - step) / tau), -direction
        shape.append(part * direction + (1 - part) * after)
    return np.array(shape)
