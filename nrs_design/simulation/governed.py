"""The hardest steps of the reference below a safety layer: a run that nearly reaches the bound."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from nrs_design.proof.safety import SampledMotor
from nrs_design.proof.saturation import Governed
from nrs_design.simulation.switched import SwitchedRun

# Behind them, nothing is left of a response.
LEFT = 1e-6


def hardest_run(loop: Governed, period: Fraction) -> SwitchedRun:
    """Return the run from rest whose last velocity is the largest, for the motor in the middle.

    Every step of the reference is the largest one, with the sign of what it does to the last
    velocity. The modes are 0 for steps forward and 1 for steps back; the states are error, error
    before and velocity.

    Parameters
    ----------
    loop : Governed
        With its safety layer.
    period : Fraction
        In s.
    """
    motor = SampledMotor.of(loop, period)
    A = np.array([[float(entry) for entry in row] for row in motor.matrix(loop)])
    radius = float(np.abs(np.linalg.eigvals(A)).max())
    count = int(np.ceil(np.log(LEFT) / np.log(radius)))
    begin, responses = np.array([1.0, 0.0, 0.0]), []
    for _ in range(count):
        responses.append(begin[2])
        begin = A @ begin
    signs = np.sign(responses[::-1])
    states = [np.zeros(3)]
    for sign in signs:
        states.append(A @ states[-1] + [sign * float(loop.step), 0.0, 0.0])
    time = float(period) * np.arange(count + 1, dtype=np.float64)
    modes = np.where(signs < 0, 1, 0)
    return SwitchedRun(time, np.array(states, dtype=np.float64), modes)
