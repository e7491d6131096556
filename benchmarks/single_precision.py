"""The sampled loop step by step, many runs at once: the list of operations in single precision.

The law is computed as the exported C computes it, with angles that have an offset; the motor
follows its command exactly within a step. Nothing of the modes is used, so that what is proved
about them can be held against it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nrs_design.controllers.operations import StepLaw
from nrs_design.controllers.replica import step

Array = NDArray[np.float64]
Indices = NDArray[np.int64]


@dataclass(frozen=True)
class Choices:
    """What happens in every run and step; each of shape (S, N)."""

    # Which controller is in force, and how old its force sample is.
    law: Indices
    delay: Indices
    # Of the environment in N m/rad and of the motor in rad/s/rpm and s.
    stiffness: Array
    gain: Array
    time_constant: Array
    # Commanded velocity in rad/s.
    command: Array


def simulate_single_precision(
    law: StepLaw, period: float, choices: Choices, offset: Array, *, losable: bool
) -> Array:
    """Return the force at every sample, from rest at the surface; shape (S, N + 1).

    `period` is in s, `offset` the angle of the surface in rad, shape (S,); where contact is
    `losable`, the environment does not pull.
    """
    runs, steps = choices.law.shape
    theta, omega, every = offset.copy(), np.zeros(runs), np.arange(runs)
    start, nothing = offset.astype(np.float32), np.zeros(runs, np.float32)
    state = {value.name: start if value.starts_at_angle else nothing for value in law.states}
    samples = np.zeros((int(choices.delay.max()) + 1, runs), np.float32)
    forces = np.zeros((runs, steps + 1))
    for t in range(steps):
        forces[:, t] = _force(theta - offset, choices.stiffness[:, t], losable=losable)
        samples = np.concatenate([forces[None, :, t].astype(np.float32), samples[:-1]])
        given = {
            "angle": theta.astype(np.float32),
            "torque": samples[choices.delay[:, t], every],
            "velocity_command": choices.command[:, t].astype(np.float32),
        }
        made = step(law, choices.law[:, t].astype(np.uint32), given | state)
        assert made.valid.all()
        state = dict(made.states)
        Km, tau = choices.gain[:, t], choices.time_constant[:, t]
        E = np.exp(-period / tau)
        held = Km * made.outputs["command"].astype(np.float64)
        theta = theta + tau * (1 - E) * omega + (period - tau * (1 - E)) * held
        omega = E * omega + (1 - E) * held
    forces[:, steps] = _force(theta - offset, choices.stiffness[:, -1], losable=losable)
    return forces


def _force(depth: Array, stiffness: Array, *, losable: bool) -> Array:
    return np.asarray(stiffness * (np.maximum(depth, 0.0) if losable else depth))
