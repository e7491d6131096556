"""Dry friction that really sticks: velocities at the end of a step (Moreau's time stepping).

No smoothing and no threshold on the velocity: a joint sticks if some friction within its limit
stops it within the step, and then has the velocity zero. By hand, as SciPy integrates no equation
with such a jump in it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from nrs_design.robot.models.vectors import Array

# Change of the velocities at which the iteration ends, in rad/s.
ACCURACY = 1e-10
LIMIT = 20_000


@dataclass(frozen=True, slots=True)
class DryFriction:
    """The problem ``inertia v + p = impulse`` with dry friction p, for one inertia.

    Each ``|p_i| <= limit_i``, and ``p_i = limit_i sign(v_i)`` where v_i is not zero. There is
    exactly one solution, the minimum of ``v' inertia v/2 - v' impulse + sum limit_i |v_i|``. It
    is found by proximal steps in a diagonal metric that dominates the inertia, so that every step
    comes nearer; where the rotors outweigh what couples the joints, a few steps are enough.
    """

    inertia: Array  # Symmetric and positive definite, shape (n, 3, 3), in kg m^2
    metric: Array  # Diagonal of the metric, shape (n, 3)
    slack: Array  # The metric less the inertia, shape (n, 3, 3)

    @staticmethod
    def of(inertia: Array) -> DryFriction:
        """Prepare the problem for matrices of shape (n, 3, 3)."""
        metric = np.abs(inertia).sum(axis=-1)
        return DryFriction(inertia, metric, np.eye(3) * metric[:, :, None] - inertia)

    def slide_or_stick(self, impulse: Array, limit: Array, start: Array) -> Array:
        """Return the velocities in rad/s, shape (n, 3).

        The impulse in N m s is inertia times the velocity that there would be without friction, the
        limit the largest impulse of the friction, and the start a guess of the velocities.
        """
        v = start
        for _ in range(LIMIT):
            push = impulse + (self.slack @ v[..., None])[..., 0]
            new: Array = (push - np.minimum(np.maximum(push, -limit), limit)) / self.metric
            change = np.abs(new - v).max()
            v = new
            if change <= ACCURACY:
                return v
        raise ArithmeticError("the velocities under dry friction do not converge")
