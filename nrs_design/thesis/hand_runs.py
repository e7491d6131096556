"""Chapter 7, simulated: a hand moves the robot through 15 deg with the admittances of table 7.1.

The thesis drives the endoscope with a motor and a handle, and prints neither its torque nor its
speed. Two operators stand for it: a hand that pushes with the torque limit of 6.3.1 whatever
happens, and one that moves on with the largest speed of 6.3.1 behind a stiffness of its own, that
of surgeons' hands as cited in 6.1. They are ends between which an operator is, and no fits.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from nrs_design.models.motion_loop import realize
from nrs_design.simulation.metrics import Effort, effort
from nrs_design.simulation.time_response import Array
from nrs_design.thesis import thesis
from nrs_design.thesis.comparison import Recomputed
from nrs_design.thesis.hands_on import ADMITTANCES

# Thesis 7.2.2: phi goes from 0 to -15 deg; and 6.1: 1002 N/m, at the lever arm of 0.24 m.
WAY = math.radians(15)
HAND = float(Fraction(1002) * Fraction("0.24") ** 2)
_STEP = 1e-3
# Experiments that are compared, by index, and what is printed of speed and applied torque, in %.
PAIRS = ((0, 1), (1, 2), (3, 4), (4, 5), (0, 3), (1, 4), (2, 5))
SPEEDS = (-6, -5, -2, -2, -35, -33, -30)
TORQUES = (4, 7, 1, 0, 97, 92, 79)


@dataclass(frozen=True, slots=True, eq=False)
class HandRun:
    """What one move shows, until the way is made."""

    # t, angle, velocity, torque: shape (N,). Time in s; of the robot, rad and rad/s; of the hand, N
    # m.
    t: Array
    angle: Array
    velocity: Array
    torque: Array
    effort: Effort  # Of the hand
    last: float  # Velocity of the admittance at the end, rad/s

    @property
    def time(self) -> float:
        """How long the way takes, s."""
        return float(self.t[-1])


def move(Mt: float, Bt: float, stiffness: float | None = None) -> HandRun:
    """Simulate ``Mt vm' + Bt vm = F`` above the motion loop until the way is made.

    The hand pushes with `thesis.TORQUE`; with a stiffness in N m/rad, it moves on at
    `thesis.VELOCITY`.
    """
    from scipy.linalg import expm

    motion = realize(thesis.CLOSED_LOOP)
    Ap, C = np.array(motion.A, float), np.array(motion.C, float)
    n = len(C)
    # After those of the motion loop: velocity of the admittance, angle, way of the hand, one.
    velocity, angle, hand, one = range(n, n + 4)
    F, A = np.zeros(n + 4), np.zeros((n + 4, n + 4))
    if stiffness is None:
        F[one] = thesis.TORQUE
    else:
        F[hand], F[angle] = stiffness, -stiffness
    A[:n, :n], A[n - 1, velocity] = Ap, 1.0
    A[velocity] = F / Mt
    A[velocity, velocity] -= Bt / Mt
    A[angle, :n], A[hand, one] = C, thesis.VELOCITY
    step, states = expm(_STEP * A), [np.eye(n + 4)[one]]
    while states[-1][angle] < WAY:
        states.append(step @ states[-1])
    before, after = states[-2], states[-1]
    share = (WAY - before[angle]) / (after[angle] - before[angle])
    states[-1] = before + share * (after - before)
    z = np.array(states)
    t = _STEP * np.arange(len(z), dtype=float)
    t[-1] = t[-2] + share * _STEP
    torque, speed = z @ F, z[:, :n] @ C
    found = effort(t, torque, speed)
    return HandRun(t, z[:, angle], speed, torque, found, float(z[-1, velocity]))


def changes(values: list[float]) -> tuple[float, ...]:
    """Return by how much each pair of `PAIRS` differs, in % of the first."""
    return tuple(100 * (values[after] / values[before] - 1) for before, after in PAIRS)


def results() -> Iterator[Recomputed]:
    """Simulate the six experiments with both operators."""
    pushed = [move(*admittance) for admittance in ADMITTANCES]
    led = [move(*admittance, HAND) for admittance in ADMITTANCES]
    slow, fast = (changes([WAY / run.time for run in runs]) for runs in (pushed, led))
    near = all(abs(slow[i] - SPEEDS[i]) < 1 for i in range(4))
    yield Recomputed(slow, near and all(change < 0 for change in slow))
    between = zip(fast[4:], SPEEDS[4:], slow[4:], strict=True)
    yield Recomputed(fast, all(led > printed > pushed for led, printed, pushed in between))
    low, high = (changes([run.effort.total for run in runs]) for runs in (pushed, led))
    pairs = zip(low, TORQUES, strict=True)
    yield Recomputed(low, all(ours > 0 and abs(ours - theirs) < 12 for ours, theirs in pairs))
    yield Recomputed(high, all(ours > 0 for ours in high))
    found = [run.effort for run in pushed]
    energies = [e.energy for e in found]
    numbers = (*(e.total for e in found), max(e.rms for e in found), max(energies))
    yield Recomputed(numbers, max(energies) - min(energies) < 1e-3)
