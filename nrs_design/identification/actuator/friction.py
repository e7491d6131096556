"""Coulomb friction in time: which way it acts, and where the motor sticks."""

from __future__ import annotations

import math

import numpy as np

from nrs_design.identification.held import Held
from nrs_design.identification.numeric import Array


def friction_shape(held: Held, gain: float, tau: float, friction: float) -> Array:
    """Return friction over its largest value, the mean over each interval, shape (m - 1,).

    It is 1 or -1 against the motion, from rest on. Where the velocity reaches zero while the
    command is below the friction (in units of the command), the motor sticks, and the friction is
    just the command. A reversal within an interval is found exactly.
    """
    decays = np.exp(-held.steps / tau)
    factor = (1 - decays) * gain
    steps = zip(
        held.steps.tolist(),
        held.command.tolist(),
        decays.tolist(),
        (factor * (held.command - friction)).tolist(),
        (factor * (held.command + friction)).tolist(),
        strict=True,
    )
    shape = []
    velocity, direction = 0.0, 1.0
    # A loop: where the motor turns back, which it does often, is known only on the way there.
    for step, command, decay, forward, backward in steps:
        if velocity == 0.0:
            if abs(command) <= friction:
                shape.append(command / friction)
                continue
            direction = math.copysign(1.0, command)
        before = velocity
        velocity = decay * before + (forward if direction > 0.0 else backward)
        if velocity * direction >= 0.0:
            shape.append(direction)
            continue
        target = gain * (command - friction * direction)
        stop = -tau * math.log(target / (target - before))
        if abs(command) <= friction:
            velocity, after = 0.0, command / friction
        else:
            turned = gain * (command + friction * direction)
            velocity, after = turned * -math.expm1((stop - step) / tau), -direction
        shape.append((stop * direction + (step - stop) * after) / step)
        direction = -direction
    return np.array(shape)
