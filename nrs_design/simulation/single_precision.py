"""The sampled loop step by step, its law in single precision: many runs at once.

The law computes as `nrs_design.controllers.sampled` lists it, with angles that have an offset; the
motor follows its command exactly within a step. Nothing of the exact model is used, so that what is
proved about that can be held against it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nrs_design.controllers.sampled import SampledAdmittance, SampledMotion

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Single = np.float32


@dataclass(frozen=True)
class Choices:
    """What happens in every run and step."""

    # law, delay: shape (S, N). Which admittance is in force, and how old its force sample is.
    law: Indices
    delay: Indices
    # stiffness, gain, time_constant: shape (S, N). Of the environment in N m/rad and of the motor
    # in rad/s/rpm and s.
    stiffness: Array
    gain: Array
    time_constant: Array
    command: Array  # Shape (S, N). Commanded velocity in rad/s.


def simulate_single_precision(
    motion: SampledMotion,
    laws: Sequence[SampledAdmittance],
    period: float,
    choices: Choices,
    offset: Array,
    *,
    losable: bool,
) -> Array:
    """Return the force at every sample, from rest at the surface; shape (S, N + 1).

    Parameters
    ----------
    motion : SampledMotion
        The motion controller.
    laws : sequence of SampledAdmittance
        Of all controllers: all with inertia, or none.
    period : float
        In s.
    choices : Choices
        What happens.
    offset : ndarray, shape (S,)
        Angle of the surface in rad.
    losable : bool
        Whether the environment does not pull.

    Raises
    ------
    ValueError
        If a law has a spring: the command moves what it draws to.
    """
    if any(law.Kt for law in laws):
        raise ValueError("an admittance with a spring Kt is not simulated here")
    runs, steps = choices.law.shape
    Kp, D = Single(float(motion.Kp)), Single(float(motion.D))
    T = Single(float(laws[0].T))
    a = np.array([float(law.a or 0) for law in laws], dtype=Single)
    b = np.array([float(law.b) for law in laws], dtype=Single)
    theta, omega = offset.copy(), np.zeros(runs)
    reference = offset.astype(Single)
    before, velocity = np.zeros(runs, Single), np.zeros(runs, Single)
    samples = np.zeros((int(choices.delay.max()) + 1, runs), Single)
    forces, every = np.zeros((runs, steps + 1)), np.arange(runs)
    for t in range(steps):
        depth = theta - offset
        forces[:, t] = choices.stiffness[:, t] * (np.maximum(depth, 0.0) if losable else depth)
        samples = np.concatenate([forces[None, :, t].astype(Single), samples[:-1]])
        error = reference - theta.astype(Single)
        drive = Kp * error + D * (error - before)
        force, law = samples[choices.delay[:, t], every], choices.law[:, t]
        if laws[0].a is None:
            velocity = b[law] * force
        reference = reference + T * (choices.command[:, t].astype(Single) - velocity)
        if laws[0].a is not None:
            velocity = a[law] * velocity + b[law] * force
        before = error
        Km, tau = choices.gain[:, t], choices.time_constant[:, t]
        E = np.exp(-period / tau)
        held = Km * drive.astype(np.float64)
        theta = theta + tau * (1 - E) * omega + (period - tau * (1 - E)) * held
        omega = E * omega + (1 - E) * held
    depth = theta - offset
    last = choices.stiffness[:, -1] * (np.maximum(depth, 0.0) if losable else depth)
    forces[:, steps] = last
    return forces
