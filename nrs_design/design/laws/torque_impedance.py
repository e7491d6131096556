"""Impedance control at torque level: the gains are given, and what they make of the joint."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from nrs_design.controllers.controller_design import Controller
from nrs_design.controllers.parts import FORCE_GAIN
from nrs_design.design.laws.law import AbstractControllerAnalysis, LawDesign, Task, choose_given
from nrs_design.design.virtual_wall import Wall, passivity_margin
from nrs_design.proof.bounds import lower
from nrs_design.spec.controllers import TorqueImpedanceSpec


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
