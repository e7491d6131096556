"""What the designed gains achieve: poles, cost and margins, for people to judge."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

from nrs_design.controllers.controller_design import (
    Controller,
    ControllerDesign,
    ImpedanceOptimum,
)
from nrs_design.controllers.gain_range import gain_interval
from nrs_design.controllers.laws import Admittance, ProportionalForce
from nrs_design.design.design import (
    impedance_problem,
    naming,
    root_locus_design,
    to_transfer_function,
)
from nrs_design.design.doubts import doubt_bounds, doubt_values
from nrs_design.design.force_loop import ForceLoop, force_loop_response
from nrs_design.design.goals import Achieved, achieve_force, achieve_impedance
from nrs_design.design.impedance import (
    ImpedanceProblem,
    impedance_cost,
    optimize_impedance,
)
from nrs_design.design.margins import LoopMargins, loop_margins, stiffness_limit
from nrs_design.design.measures import FORCE_MEASURES, IMPEDANCE_MEASURES
from nrs_design.design.requirements import requirement_of
from nrs_design.design.root_locus import MotionLoopResponse, PdDesign, motion_loop_response
from nrs_design.design.transfer import TransferFunction
from nrs_design.models.motion_loop import MotionLoop
from nrs_design.models.plant import Plant
from nrs_design.spec import (
    Doubt,
    ForceControllerSpec,
    ImpedanceControllerSpec,
    InteractionDesignSpec,
)


@dataclass(frozen=True, slots=True)
class ImpedanceAnalysis:
    """One impedance controller.

    Parameters
    ----------
    name : str
        Of the controller.
    problem : ImpedanceProblem
        What was minimized.
    optimum : ImpedanceOptimum
        Before rounding.
    Mt, Bt : float
        As shipped, in kg m^2 and N m s/rad.
    cost : float
        Of the shipped gains.
    margins : LoopMargins
        Of the shipped gains, in nominal contact.
    highest_stiffness : float
        Upper end of the stiffness of the environment that it was designed for, in N m/rad.
    lowest_limit : float
        Smallest stiffness limit in N m/rad, of the shipped gains and of the corners of their
        declared ranges.
    achieved : tuple of Achieved
        The worst values over the contacts, beside the goals.
    """

    name: str
    problem: ImpedanceProblem
    optimum: ImpedanceOptimum
    Mt: float
    Bt: float
    cost: float
    margins: LoopMargins
    highest_stiffness: float
    lowest_limit: float
    achieved: tuple[Achieved, ...]


@dataclass(frozen=True, slots=True)
class ForceAnalysis:
    """One force controller.

    Parameters
    ----------
    name : str
        Of the controller.
    stiffness : float
        Of nominal contact, in N m/rad.
    loop : ForceLoop
        Closed in nominal contact.
    achieved : tuple of Achieved
        The worst values over the contacts, beside the goals.
    """

    name: str
    stiffness: float
    loop: ForceLoop
    achieved: tuple[Achieved, ...]


@dataclass(frozen=True, slots=True)
class DesignAnalysis:
    """Everything a person wants to see beside the gains.

    Parameters
    ----------
    wanted : PdDesign
        What the root locus asks for.
    motion : TransferFunction
        The motion loop G in use.
    motion_source : {"designed", "given"}
        Whether G follows from the PD gains, or the spec states it.
    reached : MotionLoopResponse
        Poles, damping and overshoot that G really has.
    impedance : tuple of ImpedanceAnalysis
        One for each impedance controller.
    force : tuple of ForceAnalysis
        One for each force controller.
    warnings : tuple of Doubt
        What is doubtful about the design, and no goal speaks of it.
    """

    wanted: PdDesign
    motion: TransferFunction
    motion_source: str
    reached: MotionLoopResponse
    impedance: tuple[ImpedanceAnalysis, ...]
    force: tuple[ForceAnalysis, ...]
    warnings: tuple[Doubt, ...]

    @property
    def measured(self) -> tuple[ImpedanceAnalysis | ForceAnalysis, ...]:
        """All controllers that goals are for."""
        return (*self.impedance, *self.force)


def analyze_design(
    spec: InteractionDesignSpec, plant: Plant, design: ControllerDesign
) -> DesignAnalysis:
    """Compute poles, costs and margins of a design.

    Parameters
    ----------
    spec : InteractionDesignSpec
        What was asked for.
    plant : Plant
        That it describes.
    design : ControllerDesign
        As `nrs_design.design.design.design_controllers` gives it.

    Raises
    ------
    DesignError
        If a nominal loop is unstable, so that it has no margins.
    """
    loop = plant.motion_loop(design.motion.Kp, design.motion.Kd)
    motion = to_transfer_function(loop)
    impedance = tuple(
        _impedance(spec, plant, loop, controller, controller.law)
        for controller in design.controllers
        if isinstance(controller.law, Admittance)
    )
    force = tuple(
        _force(spec, plant, motion, controller, controller.law)
        for controller in design.controllers
        if isinstance(controller.law, ProportionalForce)
    )
    return DesignAnalysis(
        wanted=root_locus_design(spec),
        motion=motion,
        motion_source="designed" if spec.motion_loop.transfer_function is None else "given",
        reached=motion_loop_response(motion),
        impedance=impedance,
        force=force,
        warnings=tuple(_warnings(spec, impedance, force)),
    )


def _warnings(
    spec: InteractionDesignSpec,
    impedance: tuple[ImpedanceAnalysis, ...],
    force: tuple[ForceAnalysis, ...],
) -> Iterator[Doubt]:
    for item in impedance:
        yield from doubt_values(item.name, item.achieved)
        yield from doubt_bounds(item.name, _impedance_spec(spec, item.name), item.optimum)
    for loop in force:
        yield from doubt_values(loop.name, loop.achieved)


def _impedance_spec(spec: InteractionDesignSpec, name: str) -> ImpedanceControllerSpec:
    controller = spec.controllers[name]
    assert isinstance(controller, ImpedanceControllerSpec)
    return controller


def _impedance(
    spec: InteractionDesignSpec,
    plant: Plant,
    loop: MotionLoop,
    controller: Controller,
    law: Admittance,
) -> ImpedanceAnalysis:
    given = _impedance_spec(spec, controller.name)
    problem = impedance_problem(spec, plant, loop, given)
    requirement = requirement_of(spec, plant, problem.loop.motion, given)
    Mt, Bt = float(law.Mt), float(law.Bt)
    with naming(controller.name):
        margins = loop_margins(problem.loop, Mt, Bt)
    corners = product(gain_interval(given.Mt, law.Mt).ends, gain_interval(given.Bt, law.Bt).ends)
    limits = (
        stiffness_limit(problem.loop, float(mass), float(damping))
        for (_, mass), (_, damping) in corners
    )
    return ImpedanceAnalysis(
        name=controller.name,
        problem=problem,
        # Gains that the spec gives are their own optimum.
        optimum=controller.optimum or optimize_impedance(problem),
        Mt=Mt,
        Bt=Bt,
        cost=float(impedance_cost(problem, Mt, Bt)),
        margins=margins,
        highest_stiffness=float(plant.environment(given.environment).stiffness.high),
        lowest_limit=min(margins.stiffness_limit, *limits),
        achieved=achieve_impedance(requirement, IMPEDANCE_MEASURES, Mt, Bt),
    )


def _force(
    spec: InteractionDesignSpec,
    plant: Plant,
    motion: TransferFunction,
    controller: Controller,
    law: ProportionalForce,
) -> ForceAnalysis:
    given = spec.controllers[controller.name]
    assert isinstance(given, ForceControllerSpec)
    requirement = requirement_of(spec, plant, motion, given)
    stiffness = plant.environment(controller.environment or "").nominal.stiffness
    with naming(controller.name):
        loop = force_loop_response(motion, stiffness, float(law.Kp))
    achieved = achieve_force(requirement, FORCE_MEASURES, float(law.Kp))
    return ForceAnalysis(controller.name, stiffness, loop, achieved)
