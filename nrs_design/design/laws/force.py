"""Choose the gain of a force controller, and analyze it."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from nrs_design.controllers.controller_design import Controller
from nrs_design.controllers.float32 import round_float32, round_significant
from nrs_design.controllers.laws import ProportionalForce
from nrs_design.design.force_loop import (
    Approach,
    ForceLoop,
    design_force_gain,
    force_loop_response,
    peak_force,
)
from nrs_design.design.goals import ForceRequirement
from nrs_design.design.laws.law import (
    AbstractControllerAnalysis,
    Choice,
    LawDesign,
    Task,
    goals_of,
    naming,
)
from nrs_design.design.measures import FORCE_ERROR, FORCE_MEASURES, Measure
from nrs_design.design.proved_margins import RangedLoop, ranged_loops
from nrs_design.design.transfer import TransferFunction
from nrs_design.loop.cut_loop import ContinuousAxis
from nrs_design.spec.controllers import ForceControllerSpec, IntegralControllerSpec


@dataclass(frozen=True)
class ForceAnalysis(AbstractControllerAnalysis):
    """One force controller."""

    stiffness: float  # Stiffness of nominal contact, in N m/rad
    loop: ForceLoop  # Closed in nominal contact
    approach: Approach  # Approach to the force limit of the spec, at the largest velocity
    steady_error: float  # Lasting force error over the force, of the declared law
    peak: float | None  # Largest force then, in N m; None without offset
    # Factor of Kp times the stiffness in the open loop: G, or ``(s + Ki/Kp)/s G``.
    forward: TransferFunction


def proportional_gain(task: Task, spec: ForceControllerSpec | IntegralControllerSpec) -> Fraction:
    """Return the given Kp, or the Kp with the damping ratio of the spec."""
    if spec.proportional_gain is not None:
        return round_float32(spec.proportional_gain.exact)
    stiffness = task.stiffness(spec)
    gain = design_force_gain(task.followed(spec), stiffness, float(spec.damping_ratio or 0))
    return round_float32(round_significant(gain, task.digits))


def choose(task: Task, given: ForceControllerSpec) -> Choice:
    """Return the law with that gain."""
    return ProportionalForce(proportional_gain(task, given)), None


def analyze(task: Task, given: ForceControllerSpec, controller: Controller) -> ForceAnalysis:
    """Close the loop in nominal contact, which must be stable, and measure it in all contacts."""
    limits = task.spec.limits
    approach = Approach(given.offset, limits.velocity.si, limits.torque.si)
    forward = task.followed(given)
    return analyze_approach(task, given, controller, forward, approach, FORCE_MEASURES)


def analyze_approach(
    task: Task,
    given: ForceControllerSpec | IntegralControllerSpec,
    controller: Controller,
    forward: TransferFunction,
    approach: Approach,
    measures: tuple[Measure, ...],
) -> ForceAnalysis:
    """Do so for any law, with what its Kp times the stiffness multiplies in the open loop.

    An error that is not among the measures is nil.
    """
    goals = goals_of(task.spec, given, measures)
    stiffness, gain = task.stiffness(given), float(controller.law.gains["Kp"])
    requirement = ForceRequirement(
        task.axis, task.corners(given), goals, controller.law, forward, approach
    )
    left, loops = 0.0, tuple[RangedLoop, ...]()
    with naming(controller.name):
        loop = force_loop_response(forward, stiffness, gain)
        if FORCE_ERROR in measures:
            contact = task.plant.environment(str(given.environment)).nominal
            left = requirement.steady_error(contact, requirement.corners[0].place)
        peak = peak_force(task.motion, stiffness, gain, approach)
        achieved = requirement.achieved(measures)
    if isinstance(task.axis, ContinuousAxis) and task.plant.actuator_ranges.fixed:
        loops = ranged_loops(task.axis, controller.law, task.contacts(given), {})
    return ForceAnalysis(
        controller.name, achieved, stiffness, loop, approach, left, peak, forward, loops=loops
    )


DESIGN = LawDesign(choose, analyze)
