"""Choose the gain of a force controller, and analyze it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from nrs_design.controllers.controller_design import Controller
from nrs_design.controllers.float32 import round_significant, to_float32
from nrs_design.controllers.laws import CompliantLaw, ProportionalForce
from nrs_design.design.force_limit import Approach, peak_force, steady_force_error
from nrs_design.design.force_loop import ForceLoop, design_force_gain, force_loop_response
from nrs_design.design.goals import Achieved, ForceRequirement
from nrs_design.design.laws.law import (
    AbstractControllerAnalysis,
    Choice,
    LawDesign,
    Task,
    goals_of,
    naming,
)
from nrs_design.design.measures import FORCE_MEASURES
from nrs_design.design.proved_margins import RangedLoop, ranged_loops, with_proofs
from nrs_design.design.transfer import TransferFunction
from nrs_design.loop.cut_loop import ContinuousAxis
from nrs_design.spec import ForceControllerSpec
from nrs_design.spec.controllers import IntegralControllerSpec


@dataclass(frozen=True)
class ForceAnalysis(AbstractControllerAnalysis):
    """One force controller."""

    stiffness: float  # Of nominal contact, in N m/rad
    loop: ForceLoop  # Closed in nominal contact
    # How the limit of the spec on the force is reached: at the largest velocity.
    approach: Approach
    # What is left of the force error then, over the force; of the law as declared.
    steady_error: float
    peak: float | None  # Largest force then, in N m; None without offset
    # What Kp times the stiffness multiplies in the open loop: G, or that with an integral.
    forward: TransferFunction
    # Over whose ranges margins can be proved; empty for a sampled law, or one over a motor with
    # ranges.
    loops: tuple[RangedLoop, ...] = ()

    @property
    def is_provable(self) -> bool:
        """Whether margins can be proved over all values of the ranges."""
        return bool(self.loops)

    def prove(self, achieved: Sequence[Achieved]) -> tuple[Achieved, ...]:
        """Return worst values with what is proved of them over all values of the ranges."""
        return with_proofs(achieved, self.loops)


def loops_of(
    task: Task, given: ForceControllerSpec | IntegralControllerSpec, law: CompliantLaw
) -> tuple[RangedLoop, ...]:
    """Return the loops over whose ranges the margins of a law can be proved."""
    if not isinstance(task.axis, ContinuousAxis) or not task.plant.actuator_ranges.fixed:
        return ()
    return ranged_loops(task.axis, law, task.contacts(given), {})


def proportional_gain(task: Task, given: ForceControllerSpec | IntegralControllerSpec) -> Fraction:
    """Return the Kp that the spec gives, or the one with the damping ratio that it wants."""
    if given.proportional_gain is not None:
        return to_float32(given.proportional_gain.exact)
    stiffness = task.stiffness(given)
    gain = design_force_gain(task.motion, stiffness, float(given.damping_ratio or 0))
    return to_float32(round_significant(gain, task.digits))


def choose(task: Task, given: ForceControllerSpec) -> Choice:
    """Return the law with that gain."""
    return ProportionalForce(proportional_gain(task, given)), None


def analyze(task: Task, given: ForceControllerSpec, controller: Controller) -> ForceAnalysis:
    """Close the loop in nominal contact, which must be stable, and measure it in all contacts."""
    goals = goals_of(task.spec, given, FORCE_MEASURES)
    stiffness = task.stiffness(given)
    gain = float(controller.law.gains["Kp"])
    limits = task.spec.limits
    approach = Approach(given.offset, limits.velocity.si, limits.torque.si)
    requirement = ForceRequirement(
        task.axis, task.corners(given), goals, controller.law, task.motion, approach
    )
    with naming(controller.name):
        loop = force_loop_response(task.motion, stiffness, gain)
        left = steady_force_error(task.motion, stiffness, gain, approach)
        peak = peak_force(task.motion, stiffness, gain, approach)
        achieved = requirement.achieved(FORCE_MEASURES)
    loops = loops_of(task, given, controller.law)
    return ForceAnalysis(
        controller.name, achieved, stiffness, loop, approach, left, peak, task.motion, loops
    )


DESIGN = LawDesign(choose, analyze)
