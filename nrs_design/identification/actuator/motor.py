"""The motor in time: output for given parameters, and its derivatives."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from nrs_design.identification.datasets.records import SignalRecord
from nrs_design.identification.numeric import Array, reject
from nrs_design.identification.zero_order_hold import HeldCommand, Lags

# Step of a difference quotient in a logarithm. The step of the dead time, in samples, is larger by
# this factor.
_DIFFERENCE = 1e-5
_DELAY_DIFFERENCE = 100.0
# A record begins in motion at this part of the velocity that the largest command leads to.
_MOVES = 0.2


def friction_shape(
    zoh: HeldCommand, gain: float, tau: float, friction: float, velocity: float = 0.0
) -> Array:
    """Return friction over its largest value, the mean over each interval, shape (m - 1,).

    It is 1 or -1 against the motion, from a first velocity on. Where the velocity reaches zero
    while the command is below the friction (in units of the command), the motor sticks, and the
    friction is just the command. A reversal within an interval is found exactly.
    """
    decays = np.exp(-zoh.steps / tau)
    factor = (1 - decays) * gain
    steps = zip(
        zoh.steps.tolist(),
        zoh.command.tolist(),
        decays.tolist(),
        (factor * (zoh.command - friction)).tolist(),
        (factor * (zoh.command + friction)).tolist(),
        strict=True,
    )
    shape = []
    direction = math.copysign(1.0, velocity)
    # A loop: each reversal depends on the motion before it.
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
            new_target = gain * (command + friction * direction)
            velocity, after = new_target * -math.expm1((stop - step) / tau), -direction
        shape.append((stop * direction + (step - stop) * after) / step)
        direction = -direction
    return np.array(shape)


@dataclass(frozen=True, slots=True)
class MotorModel:
    """``tau v' + v = gain (command(t - delay) - friction sign(v))``."""

    gain: float  # In rad/s for each unit of the command
    time_constant: float  # In s
    friction: float | None  # In units of the command; None for a motor without friction
    delay: float  # Dead time in s

    @property
    def lags(self) -> Lags:
        """Its linear part of unit gain."""
        return Lags.first_order(self.time_constant)

    @property
    def parameters(self) -> Array:
        """Logarithms of all but the dead time, and the dead time in s."""
        positive = (self.gain, self.time_constant, self.friction)
        return np.array([*(np.log(p) for p in positive if p is not None), self.delay])

    def replace_parameters(self, x: Array) -> Self:
        """Return the same kind of motor with other parameters."""
        gain, tau, *friction = np.exp(x[:-1]).tolist()
        return replace(
            self,
            gain=gain,
            time_constant=tau,
            friction=friction[0] if friction else None,
            delay=float(x[-1]),
        )

    def hold(self, record: SignalRecord) -> tuple[HeldCommand, Array | None]:
        """Return the command of a record as it acts, and the shape of the friction."""
        zoh = HeldCommand.build(record.time, record.command, self.delay)
        if self.friction is None:
            return zoh, None
        first, fast = record.first_velocity, self.gain * float(np.abs(record.command).max())
        # A little of it may be noise.
        first = first if abs(first) > _MOVES * fast else 0.0
        return zoh, friction_shape(zoh, self.gain, self.time_constant, self.friction, first)

    def forced(self, record: SignalRecord, zoh: HeldCommand, shape: Array | None) -> Array:
        """Return the output from rest at the samples of a record, shape (n,)."""
        friction = 0.0 if shape is None or self.friction is None else self.friction * shape
        inputs = self.gain * (zoh.command - friction)
        output = self.lags.angle if record.is_angle else self.lags.velocity
        return output(zoh, inputs)[zoh.samples]

    def free(self, record: SignalRecord) -> Array:
        """Return what initial angle and velocity add, shape (n, p)."""
        return self.lags.free(record.time, angle=record.is_angle)

    def simulate(self, record: SignalRecord) -> Array:
        """Return the output in rad or rad/s, its initial state fitted to a record, shape (n,)."""
        return record.output - self.errors(record)

    def errors(self, record: SignalRecord) -> Array:
        """Return measured less fitted output, shape (n,)."""
        return self.remove_initial_state(
            record, record.output - self.forced(record, *self.hold(record))
        )

    def derivatives(self, record: SignalRecord) -> Array:
        """Return the derivatives of the fitted output by the parameters, shape (n, p).

        With the parameters, the times move at which the motor turns or sticks: differences of
        whole simulations see it.
        """
        x = self.parameters
        sizes = np.full(len(x), _DIFFERENCE)
        sizes[-1] *= _DELAY_DIFFERENCE * record.step

        def output(y: Array) -> Array:
            motor = self.replace_parameters(y)
            return motor.forced(record, *motor.hold(record))

        steps = np.diag(sizes)
        columns = [(output(x + h) - output(x - h)) / (2 * h.sum()) for h in steps]
        return self.remove_initial_state(record, np.column_stack(columns))

    def remove_initial_state(self, record: SignalRecord, values: Array) -> Array:
        """Return what no initial state explains."""
        free, _ = np.linalg.qr(self.free(record))
        return reject(free, values)
