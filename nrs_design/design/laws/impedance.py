"""Choose the gains of an impedance controller, and analyze them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from nrs_design.controllers.controller_design import Controller, ImpedanceOptimum
from nrs_design.controllers.float32 import (
    exact_decimal,
    neighbors,
    round_float32,
    round_significant,
)
from nrs_design.controllers.laws import Admittance
from nrs_design.design.constrained import best_rounding, meets, optimize_with_goals
from nrs_design.design.doubts import doubt_bounds, doubt_stiffness
from nrs_design.design.goals import NOT_COMPUTED, Achieved, Requirement
from nrs_design.design.impedance_optimum import ImpedanceLoop, ImpedanceProblem, impedance_cost
from nrs_design.design.laws.law import (
    AbstractControllerAnalysis,
    Choice,
    LawDesign,
    Task,
    goals_of,
    naming,
)
from nrs_design.design.measures import CREEP_MEASURES, HAND_MEASURES, IMPEDANCE_MEASURES, Measure
from nrs_design.design.passivity import PassiveBand, passive_band
from nrs_design.design.proved_margins import add_proofs, ranged_loops
from nrs_design.errors import DesignError
from nrs_design.loop.cut_loop import ContinuousAxis
from nrs_design.models.axis import unit
from nrs_design.models.interval import Interval
from nrs_design.proof.bounds import lower, upper_float
from nrs_design.spec import Doubt, GainSpec, ImpedanceControllerSpec, InteractionDesignSpec
from nrs_design.spec.controllers import contact_names, names_in, touched_in
from nrs_design.spec.quantity import Quantity


@dataclass(frozen=True)
class ImpedanceAnalysis(AbstractControllerAnalysis):
    """One impedance controller."""

    given: ImpedanceControllerSpec
    problem: ImpedanceProblem  # What was minimized
    optimum: ImpedanceOptimum  # Before rounding
    # Mt, Bt: as shipped, in kg m^2 and N m s/rad; a spring is that of the loop in the problem.
    Mt: float
    Bt: float
    cost: float  # Cost of the shipped gains
    requirement: Requirement
    # Upper end of the stiffness of the environment that it was designed for, in N m/rad.
    highest_stiffness: float
    # Smallest stiffness limit in N m/rad in that environment, over the corners of all other ranges;
    # NaN where it is not computed. The stiffness of its corner does not count.
    lowest_limit: float
    limit_at: str
    stiff: tuple[Doubt, ...]  # Contacts that are too stiff for the shipped gains
    # Where the displayed admittance is passive, exactly, over the ranges of the motor; None for a
    # sampled law.
    band: PassiveBand | None = None
    lever_arm: float | None = None  # Common lever arm of all contacts, in m; None without one

    def prove(self, achieved: Sequence[Achieved]) -> tuple[Achieved, ...]:
        """Return worst values with their proofs over the ranges."""
        home, loop = self.given.environment, self.requirement
        return add_proofs(achieved, self.loops, home, loop.desired, loop.bandwidth)

    @property
    def limit_at_arm(self) -> float | None:
        """The stiffness limit where the contact is, in N/m, if its lever arm is known."""
        return self.lever_arm and self.lowest_limit / self.lever_arm**2

    @property
    def on_bound(self) -> frozenset[str]:
        """Which gains a bound of the spec has chosen, not the cost."""
        return frozenset(d.at[-1] for d in doubt_bounds(self.name, self.given, self.optimum))

    def worst(self, measure: Measure) -> Achieved:
        """Return the worst value of a measure over the ranges, and where it is."""
        return next(found for found in self.achieved if found.measure is measure)

    def shown(self, measure: Measure) -> Achieved:
        """Return the same with what is proved of it."""
        return next(found for found in self.judged if found.measure is measure)

    def doubts(self) -> Iterator[Doubt]:
        """Yield doubts about the gains, and the gains on a bound."""
        yield from super().doubts()
        if self.requirement.axis is None:
            text = f"{self.name}: margins and k limit are {NOT_COMPUTED}"
            yield Doubt(("controllers", self.name), text)
        yield from self.stiff
        yield from doubt_bounds(self.name, self.given, self.optimum)


def choose(task: Task, spec: ImpedanceControllerSpec) -> Choice:
    """Return the gains that the spec gives, or the best that its bounds and goals allow."""
    if spec.Mt.fixed and spec.Bt.fixed:
        # The certificate says whether these gains are stable.
        Mt, Bt = (round_float32(gain.min.exact) for gain in (spec.Mt, spec.Bt))
        return Admittance(Mt, Bt, _spring(spec)), None
    requirement = requirement_of(task, spec)
    problem = impedance_problem(task, spec, requirement)
    optimum = optimize_with_goals(problem, requirement)
    Mt, Bt = (_shipped(getattr(optimum, g), getattr(spec, g), task.digits) for g in ("Mt", "Bt"))
    if not meets(requirement, float(Mt), float(Bt)):
        Mt, Bt = _rounded_within(problem, requirement, optimum, spec, task.digits)
    return Admittance(Mt, Bt, _spring(spec)), optimum


def analyze(
    task: Task, given: ImpedanceControllerSpec, controller: Controller
) -> ImpedanceAnalysis:
    """Compute cost, margins and stiffness limits, and measure the loop in all contacts."""
    shipped = controller.law.gains
    Mt, Bt = float(shipped["Mt"]), float(shipped["Bt"])
    requirement = requirement_of(task, given)
    problem = impedance_problem(task, given, requirement)
    with naming(controller.name):
        _check_stable(requirement, Mt, Bt)
    limit, limit_at = min(
        found
        for name, found in requirement.stiffness_limits(Mt, Bt).items()
        if name in _home_names(given)
    )
    axis = task.axis if isinstance(task.axis, ContinuousAxis) else None
    # Gains that the spec gives are their own optimum.
    ends = given.Mt.min.si, given.Bt.min.si
    optimum = ImpedanceOptimum(*ends, float(impedance_cost(problem, *ends)))
    law, contacts, moving = controller.law, task.contacts(given), _moving(task)
    measures = (
        *_measures(task),
        *(item for item in HAND_MEASURES if item in dict(requirement.goals)),
    )
    return ImpedanceAnalysis(
        name=controller.name,
        achieved=requirement.achieved(measures, Mt, Bt),
        given=given,
        problem=problem,
        optimum=controller.optimum or optimum,
        Mt=Mt,
        Bt=Bt,
        cost=float(impedance_cost(problem, Mt, Bt)),
        requirement=requirement,
        highest_stiffness=float(
            max(task.plant.environment(name).stiffness.high for name in _home_names(given))
        ),
        lowest_limit=limit,
        limit_at=limit_at,
        stiff=tuple(doubt_stiffness(controller.name, requirement, contacts, Mt, Bt)),
        band=None if axis is None else passive_band(axis, law, moving),
        lever_arm=_lever_arm(task, given),
        # None with more than four ranges at once.
        loops=() if axis is None else ranged_loops(axis, law, contacts, moving),
    )


def _lever_arm(task: Task, given: ImpedanceControllerSpec) -> float | None:
    arms = {task.spec.environments[name].lever_arm for name in touched_in(given.contacts)}
    lengths = {None if arm is None else arm.si for arm in arms}
    return lengths.pop() if len(lengths) == 1 else None


def _check_stable(requirement: Requirement, Mt: float, Bt: float) -> None:
    """Refuse gains whose nominal loop is unstable: its margins would say nothing."""
    for corner in requirement.nominal if requirement.axis is not None else ():
        if requirement.loops(corner, np.array([Mt]), np.array([Bt])).stable[0]:
            continue
        latencies = "".join(f", {text}" for text in corner.place.texts)
        raise DesignError(
            f"the loop with Mt = {Mt:.6g} {unit('kg m^2')} and Bt = {Bt:.6g} "
            f"{unit('N m s/rad')} is unstable at {corner.contact.stiffness:.6g} "
            f"{unit('N m/rad')}{latencies}",
            remedy=f"{_stable_below(requirement, Mt, Bt)}; raise Bt or lower Mt",
            at=("Bt",),
        )


def _stable_below(requirement: Requirement, Mt: float, Bt: float) -> str:
    """Say up to which stiffness nominal contact is stable at every age of the force sample."""
    limit = min(requirement.family(c).stiffness_limit(Mt, Bt) for c in requirement.nominal)
    (motor,) = {corner.place.motor for corner in requirement.nominal}
    has_ranges = any(corner.place.motor != motor for corner in requirement.corners)
    nominal = " with the nominal motor" if has_ranges else ""
    if not limit:
        return f"it is unstable{nominal} however soft the contact is"
    return f"it is stable{nominal} below {lower(Fraction(limit), 6)} {unit('N m/rad')}"


def _moving(task: Task) -> dict[str, Interval]:
    """Return the numbers of the motor that have ranges, and where they are."""
    motor = task.plant.actuator_ranges
    ranges = {"Km": motor.gain, "tau": motor.time_constant}
    return {name: r for name, r in ranges.items() if r.low != r.high}


def too_stiff(
    task: Task, given: ImpedanceControllerSpec, controller: Controller
) -> Iterator[Doubt]:
    """Yield the contacts that are too stiff for the gains, and what would hold."""
    Mt, Bt = (float(controller.law.gains[gain]) for gain in ("Mt", "Bt"))
    requirement = requirement_of(task, given)
    yield from doubt_stiffness(controller.name, requirement, task.contacts(given), Mt, Bt)


DESIGN = LawDesign(choose, analyze, too_stiff)


def impedance_problem(
    task: Task, given: ImpedanceControllerSpec, requirement: Requirement
) -> ImpedanceProblem:
    """State the choice of one controller's virtual mass and damping as an optimization."""
    low_pass, contact = task.sensor.filter, task.plant.environment(given.environment).nominal
    lags = (1.0,) if low_pass is None else low_pass.denominator
    return ImpedanceProblem(
        loop=ImpedanceLoop(task.motion, contact, float(_spring(given)), lags),
        desired=desired_impedance(task.spec, given),
        bandwidth=task.spec.limits.bandwidth.si,
        mass_bounds=(given.Mt.min.si, given.Mt.max.si),
        damping_bounds=(given.Bt.min.si, given.Bt.max.si),
        weight_displayed=float(given.weights.displayed),
        weight_sensitivity=float(given.weights.sensitivity),
        stable=None if requirement.axis is None else requirement.stable,
    )


def with_spring(given: ImpedanceControllerSpec, Kt: Fraction | None) -> ImpedanceControllerSpec:
    """Return the spec of a controller with a chosen spring in SI, if it has a spring."""
    if given.Kt is None or Kt is None:
        return given
    spring = Quantity(f"{exact_decimal(Kt)} {unit('N*m/rad')}", Kt, unit("N*m/rad"))
    own = given.Kt.model_copy(update={"min": spring, "max": spring})
    return given.model_copy(update={"Kt": own})


def desired_impedance(spec: InteractionDesignSpec, controller: ImpedanceControllerSpec) -> float:
    """Return the desired impedance in N m s/rad, by default torque over velocity (thesis 6.2)."""
    if controller.desired_impedance is not None:
        return controller.desired_impedance.si
    ratio = controller.desired_impedance_ratio
    return (
        spec.limits.torque.si / spec.limits.velocity.si * (1.0 if ratio is None else float(ratio))
    )


def requirement_of(task: Task, given: ImpedanceControllerSpec) -> Requirement:
    """Return the goals of one controller, and all that is needed to measure it."""
    return Requirement(
        axis=task.axis,
        corners=task.corners(given, _spring(given)),
        goals=goals_of(task.spec, given, (*_measures(task), *HAND_MEASURES)),
        desired=desired_impedance(task.spec, given),
        bandwidth=task.spec.limits.bandwidth.si,
        force_error=upper_float(task.sensor.lasting),
    )


def _home_names(given: ImpedanceControllerSpec) -> tuple[str, ...]:
    """Return the environment of the design, and its combinations with others."""
    joint_contacts = (c for c in given.contacts if given.environment in names_in(c))
    return given.environment, *contact_names(tuple(joint_contacts))


def _measures(task: Task) -> tuple[Measure, ...]:
    """Return the measures of an impedance controller, with creep if its cause is known."""
    return (*IMPEDANCE_MEASURES, *(CREEP_MEASURES if task.sensor.errors else ()))


def _rounded_within(
    problem: ImpedanceProblem,
    requirement: Requirement,
    optimum: ImpedanceOptimum,
    given: ImpedanceControllerSpec,
    digits: int,
) -> tuple[Fraction, Fraction]:
    """Return the cheapest rounded gains near an optimum at the edge of what its goals allow."""
    Mts, Bts = (
        [float(_shipped(neighbor, bounds, digits)) for neighbor in neighbors(value, digits)]
        for value, bounds in ((optimum.Mt, given.Mt), (optimum.Bt, given.Bt))
    )
    pair = best_rounding(problem, requirement, (Mts, Bts))
    if pair is None:
        raise DesignError(
            f"no gains of {digits} significant digits near Mt = {optimum.Mt:.6g} {unit('kg m^2')} "
            f"and Bt = {optimum.Bt:.6g} {unit('N m s/rad')} meet the goals",
            remedy="raise design.significant_digits (at most 7), or relax a goal",
        )
    return Fraction(pair[0]), Fraction(pair[1])


def _spring(given: ImpedanceControllerSpec) -> Fraction:
    """Return Kt as the robot holds it; zero where the spec gives none."""
    return Fraction(0) if given.Kt is None else round_float32(given.Kt.min.exact)


def _shipped(value: float, bounds: GainSpec, digits: int) -> Fraction:
    """Round a gain, keep it within its bounds, and round it to single precision."""
    shipped = round_significant(value, digits)
    return round_float32(min(max(shipped, bounds.min.exact), bounds.max.exact))
