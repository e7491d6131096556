"""A spring and a damper that a processor computes, on a joint with friction: a virtual wall.

Passive, whatever touches it and whatever mass it has, exactly for ``b > K T/2 + |B|`` where
commands take effect at once (Colgate and Schenkel, "Passivity of a class of sampled-data systems",
Journal of Robotic Systems 14, 1997). In the air it is stable about below ``(b + B)/(T/2 + t)`` with
commands that come t late, for small B (Gil, Sanchez, Hulin, Preusche and Hirzinger, "Stability
boundary for haptic rendering", Journal of Computing and Information Science in Engineering 9,
2009).
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import ceil

import numpy as np

# Halvings of an interval, and doublings until one is found.
HALVINGS, DOUBLINGS = 50, 60


@dataclass(frozen=True, slots=True)
class Wall:
    """The joint and the processor."""

    inertia: float  # In kg m^2
    friction: float  # The b in N m s/rad
    period: float  # The T in s
    late: float = 0.0  # From a sample to its command, the t in s

    def growth(self, stiffness: float, damping: float) -> float:
        """Return the spectral radius of the map of a period in the air; K and B in SI.

        The damping is by backward difference.
        """
        from scipy.linalg import expm

        T, rate = self.period, self.friction / self.inertia
        A = np.array([[-rate, 0.0, 1 / self.inertia], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
        whole = ceil(self.late / T)
        left = whole * T - self.late
        first, last = expm(A * (T - left)), expm(A * left)
        # The states: velocity, angle, the angle before, and commands from the newest on.
        n = 3 + max(whole, 1)
        law = np.zeros(n)
        law[1], law[2] = -stiffness - damping / T, damping / T
        commands = np.eye(n)[3:]
        older = law if whole == 0 else commands[whole - 1]
        newer = law if whole <= 1 else commands[whole - 2]
        M = np.zeros((n, n))
        both = last[:2, :2] @ first[:2, :2]
        M[:2, :2] = both
        M[:2] += np.outer(last[:2, :2] @ first[:2, 2], older) + np.outer(last[:2, 2], newer)
        M[2, 1] = 1.0
        M[3] = law
        M[4:, 3:-1] = np.eye(n - 4)
        return float(np.abs(np.linalg.eigvals(M)).max())

    def border(self, damping: float) -> float:
        """Return the stiffness in N m/rad up to which it is stable in the air, zero if none."""
        low, high = 0.0, self.estimate(damping) or 1.0
        if self.growth(1e-9 * high, damping) >= 1:
            return 0.0
        for _ in range(DOUBLINGS):
            if self.growth(high, damping) >= 1:
                break
            low, high = high, 2 * high
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            low, high = (middle, high) if self.growth(middle, damping) < 1 else (low, middle)
        return low

    def estimate(self, damping: float) -> float:
        """Return what Gil and others estimate for it."""
        return (self.friction + damping) / (self.period / 2 + self.late)


def passivity_margin(
    friction: Fraction, stiffness: Fraction, damping: Fraction, period: Fraction
) -> Fraction:
    """Return ``b - K T/2 - |B|`` in N m s/rad: exactly above zero, the wall is passive.

    b is the least of a range; K and B are as the processor holds them; the period T is in s.
    """
    return friction - stiffness * period / 2 - abs(damping)
