"""What the designed gains achieve: poles, cost and margins, for people to judge."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

from nrs_design.controllers.controller_design import Controller, ControllerDesign
from nrs_design.controllers.gain_range import gain_interval
from nrs_design.controllers.laws import Admittance, ProportionalForce
from nrs_design.design.design import (
    impedance_problem,
    naming,
    root_locus_design,
    to_transfer_function,
)
from nrs_design.design.force_loop import ForceLoop, force_loop_response
from nrs_design.design.impedance import (
    ImpedanceOptimum,
    ImpedanceProblem,
    impedance_cost,
    optimize_impedance,
)
from nrs_design.design.margins import LoopMargins, loop_margins, stiffness_limit
from nrs_design.design.root_locus import MotionLoopResponse, PdDesign, motion_loop_response
from nrs_design.design.transfer import TransferFunction
from nrs_design.models.motion_loop import MotionLoop
from nrs_design.models.plant import Plant
from nrs_design.spec import ImpedanceControllerSpec, InteractionDesignSpec
from nrs_design.switched.assemble import motion_loop


@dataclass(frozen=True, slots=True)
class ImpedanceEvidence:
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
    lowest_limit : float
        Smallest stiffness limit in N m/rad, of the shipped gains and of the corners of their
        declared ranges.
    """

    name: str
    problem: ImpedanceProblem
    optimum: ImpedanceOptimum
    Mt: float
    Bt: float
    cost: float
    margins: LoopMargins
    lowest_limit: float


@dataclass(frozen=True, slots=True)
class ForceEvidence:
    """One force controller: its name, and the closed force loop in nominal contact."""

    name: str
    stiffness: float
    loop: ForceLoop


@dataclass(frozen=True, slots=True)
class DesignEvidence:
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
    impedance : tuple of ImpedanceEvidence
        One for each impedance controller.
    force : tuple of ForceEvidence
        One for each force controller.
    """

    wanted: PdDesign
    motion: TransferFunction
    motion_source: str
    reached: MotionLoopResponse
    impedance: tuple[ImpedanceEvidence, ...]
    force: tuple[ForceEvidence, ...]


def examine_design(
    spec: InteractionDesignSpec, plant: Plant, design: ControllerDesign
) -> DesignEvidence:
    """Compute poles, costs and margins of a design."""
    loop = motion_loop(spec, design.motion)
    motion = to_transfer_function(loop)
    return DesignEvidence(
        wanted=root_locus_design(spec),
        motion=motion,
        motion_source="designed" if spec.motion_loop.transfer_function is None else "given",
        reached=motion_loop_response(motion),
        impedance=tuple(
            _impedance(spec, plant, loop, controller, controller.law)
            for controller in design.controllers
            if isinstance(controller.law, Admittance)
        ),
        force=tuple(
            _force(plant, motion, controller, controller.law)
            for controller in design.controllers
            if isinstance(controller.law, ProportionalForce)
        ),
    )


def _impedance(
    spec: InteractionDesignSpec,
    plant: Plant,
    loop: MotionLoop,
    controller: Controller,
    law: Admittance,
) -> ImpedanceEvidence:
    requirement = spec.controllers[controller.name]
    assert isinstance(requirement, ImpedanceControllerSpec)
    problem = impedance_problem(spec, plant, loop, requirement)
    Mt, Bt = float(law.Mt), float(law.Bt)
    with naming(controller.name):
        margins = loop_margins(problem.loop, Mt, Bt)
    corners = product(
        gain_interval(requirement.Mt, law.Mt).ends, gain_interval(requirement.Bt, law.Bt).ends
    )
    limits = (
        stiffness_limit(problem.loop, float(mass), float(damping))
        for (_, mass), (_, damping) in corners
    )
    return ImpedanceEvidence(
        name=controller.name,
        problem=problem,
        optimum=optimize_impedance(problem),
        Mt=Mt,
        Bt=Bt,
        cost=float(impedance_cost(problem, Mt, Bt)),
        margins=margins,
        lowest_limit=min(margins.stiffness_limit, *limits),
    )


def _force(
    plant: Plant, motion: TransferFunction, controller: Controller, law: ProportionalForce
) -> ForceEvidence:
    stiffness = float(plant.environment(controller.environment or "").nominal.stiffness)
    with naming(controller.name):
        loop = force_loop_response(motion, stiffness, float(law.Kp))
    return ForceEvidence(controller.name, stiffness, loop)
