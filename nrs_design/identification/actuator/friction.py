"""Coulomb friction in time: which way it acts, and where the motor sticks."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from nrs_design.identification.datasets import SinusoidRecord

Array = NDArray[np.float64]


def friction_shape(record: SinusoidRecord, gain: float, tau: float, friction: float) -> Array:
    """Return friction over its largest value, the mean over each sampling step, shape (n,).

    It is 1 or -1 against the motion. Where the velocity reaches zero while the command is below
    the friction, the motor sticks, and the friction is just the command. The command is held
    between samples, and a reversal within a step is found exactly. Starts from rest.

    Parameters
    ----------
    record : SinusoidRecord
        With the command.
    gain : float
        In (rad/s)/rpm.
    tau : float
        Time constant in s.
    friction : float
        In rpm of command.
    """
    dt = np.diff(record.time)
    decays = np.exp(-dt / tau).tolist()
    velocity = 0.0
    shape: list[float] = []
    for command, step, decay in zip(record.command.tolist(), dt.tolist(), decays, strict=False):
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
    return np.array([*shape, shape[-1]])
