"""Impedance control at torque level: the gains are given, and whether they make it passive.

They are a spring and a damper that a processor computes, on a joint with friction: a virtual wall.
Passive, whatever touches it and whatever mass it has, exactly for ``b > K T/2 + |B|`` where
commands take effect at once (Colgate and Schenkel, "Passivity of a class of sampled-data systems",
Journal of Robotic Systems 14, 1997).
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from nrs_design.controllers.controller_design import Controller
from nrs_design.controllers.parts import FORCE_GAIN
from nrs_design.design.laws.law import AbstractControllerAnalysis, LawDesign, Task, choose_given
from nrs_design.proof.bounds import lower
from nrs_design.spec.controllers import TorqueImpedanceSpec


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

    # Kp, B: stiffness in N m/rad and damping in N m s/rad as the processor holds them.
    Kp: float
    B: float
    # By how much the least friction is above what passivity takes, exactly, in N m s/rad; None
    # where the condition is not known.
    margin: Fraction | None

    @property
    def passive_text(self) -> str:
        """``yes`` or ``no`` with the margin, rounded down."""
        if self.margin is None:
            return "not decided"
        return f"{'yes' if self.margin > 0 else 'no'}, {lower(self.margin)}"


def analyze(task: Task, spec: TorqueImpedanceSpec, controller: Controller) -> TorqueAnalysis:
    """Return gains and passivity of a controller."""
    drive, sampling = task.plant.drive, task.spec.sampling
    assert drive is not None, "such a controller has a robot that takes torques"
    assert sampling is not None, "such a robot is modelled in the sampled loop"
    T = sampling.period.exact
    sampled = controller.law.discretize(T, sampling.admittance)
    Kp, B = sampled.numbers["Kp"], sampled.numbers.get("Kd_over_T", Fraction(0)) * T
    is_plain = (
        not any(task.spec.late) and sampling.jitter is None and FORCE_GAIN not in sampled.numbers
    )
    margin = passivity_margin(drive.ranges["B"].low, Kp, B, T) if is_plain else None
    return TorqueAnalysis(controller.name, (), float(Kp), float(B), margin)


DESIGN = LawDesign(choose_given, analyze)
