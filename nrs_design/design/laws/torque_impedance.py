"""Impedance control at torque level: the gains are given, and what they make of the joint.

They are a spring and a damper that a processor computes, on a joint with friction: a virtual wall.
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

from nrs_design.controllers.controller_design import Controller
from nrs_design.controllers.parts import FORCE_GAIN
from nrs_design.design.laws.law import AbstractControllerAnalysis, LawDesign, Task, choose_given
from nrs_design.proof.bounds import lower
from nrs_design.spec.controllers import TorqueImpedanceSpec


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
        from scipy.optimize import brentq

        first = 1e-9 * (self.estimate(damping) or 1.0)
        if self.growth(first, damping) >= 1:
            return 0.0
        high = 1e9 * first
        while self.growth(high, damping) < 1:
            high *= 2
        return float(brentq(lambda k: self.growth(k, damping) - 1, first, high))

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


@dataclass(frozen=True)
class TorqueAnalysis(AbstractControllerAnalysis):
    """One controller that makes torques; no goals are measured."""

    wall: Wall  # The nominal joint and the processor
    # Kp, B: stiffness in N m/rad and damping in N m s/rad as the processor holds them.
    Kp: float
    B: float
    # The stiffness up to which this damping is stable in the air, nominal, in N m/rad.
    border: float
    # By how much the least friction is above what passivity takes, exactly, in N m s/rad; None
    # where the condition is not known.
    margin: Fraction | None

    @property
    def passive_text(self) -> str:
        """Whether it is passive, in words; the margin is rounded down."""
        if self.margin is None:
            return "not decided"
        return f"{'yes' if self.margin > 0 else 'no'}, {lower(self.margin)}"


def analyze(task: Task, given: TorqueImpedanceSpec, controller: Controller) -> TorqueAnalysis:
    """Return what a controller makes of its joint."""
    drive, sampling = task.plant.drive, task.spec.sampling
    assert drive is not None, "such a controller has a robot that takes torques"
    assert sampling is not None, "such a robot is modelled in the sampled loop"
    T = sampling.period.exact
    held = controller.law.discretize(T, sampling.admittance)
    Kp, B = held.numbers["Kp"], held.numbers.get("Kd_over_T", Fraction(0)) * T
    J, b = drive.ranges["J"], drive.ranges["B"]
    wall = Wall(float(J.nominal), float(b.nominal), float(T), float(task.spec.late[1]))
    plain = not any(task.spec.late) and sampling.jitter is None and FORCE_GAIN not in held.numbers
    margin = passivity_margin(b.low, Kp, B, T) if plain else None
    border = wall.border(float(B))
    return TorqueAnalysis(controller.name, (), wall, float(Kp), float(B), border, margin)


DESIGN = LawDesign(choose_given, analyze)
