"""Choose every gain of an interaction design, rounded to the numbers that ship."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from fractions import Fraction

from nrs_design.controllers.controller_design import (
    Controller,
    ControllerDesign,
    ImpedanceOptimum,
)
from nrs_design.controllers.float32 import neighbors, round_significant, to_float32
from nrs_design.controllers.gain_range import faults_of_ranges
from nrs_design.controllers.laws import (
    Admittance,
    PositionControl,
    ProportionalDerivative,
    ProportionalForce,
)
from nrs_design.design.constrained import best_rounding, meets, optimize_with_goals
from nrs_design.design.force_loop import design_force_gain
from nrs_design.design.goals import Requirement
from nrs_design.design.impedance import ImpedanceLoop, ImpedanceProblem
from nrs_design.design.requirements import desired_impedance, requirement_of
from nrs_design.design.root_locus import PdDesign, design_pd
from nrs_design.design.transfer import TransferFunction
from nrs_design.errors import DesignError
from nrs_design.models.motion_loop import MotionLoop
from nrs_design.models.plant import Plant
from nrs_design.spec import (
    ForceControllerSpec,
    GainSpec,
    ImpedanceControllerSpec,
    InteractionDesignSpec,
    PositionControllerSpec,
)


def design_controllers(spec: InteractionDesignSpec, plant: Plant) -> ControllerDesign:
    """Choose the motion gains by root locus, then every compliant controller on top of them.

    Parameters
    ----------
    spec : InteractionDesignSpec
        Requirements and bounds.
    plant : Plant
        As `nrs_design.models.plant.build_plant` gives it.

    Raises
    ------
    DesignError
        If a requirement cannot be met within its bounds.
    """
    motion = _motion(spec)
    loop = plant.motion_loop(motion.Kp, motion.Kd)
    controllers = []
    for name, controller in spec.controllers.items():
        with naming(name):
            controllers.append(_controller(spec, plant, loop, name, controller))
    return ControllerDesign(motion, tuple(controllers))


@contextmanager
def naming(controller: str) -> Iterator[None]:
    """Say in an error which controller it is about."""
    try:
        yield
    except DesignError as error:
        message = f"controller {controller}: {error.message}"
        at = ("controllers", controller, *error.at)
        raise DesignError(message, remedy=error.remedy, at=at) from error


def root_locus_design(spec: InteractionDesignSpec) -> PdDesign:
    """Return the PD that the root locus asks for, before any rounding or given value."""
    return design_pd(
        spec.actuator.gain.nominal.si,
        spec.actuator.time_constant.nominal.si,
        float(spec.motion_loop.damping_ratio),
        spec.motion_loop.settling_time.si,
    )


def to_transfer_function(loop: MotionLoop) -> TransferFunction:
    """Return the motion loop in floating point."""
    return TransferFunction(tuple(map(float, loop.numerator)), tuple(map(float, loop.denominator)))


def impedance_problem(
    spec: InteractionDesignSpec, plant: Plant, loop: MotionLoop, controller: ImpedanceControllerSpec
) -> ImpedanceProblem:
    """State the choice of one controller's virtual mass and damping as an optimization.

    Parameters
    ----------
    spec : InteractionDesignSpec
        With the limits of torque, velocity and frequency.
    plant : Plant
        With the environment.
    loop : MotionLoop
        The motion loop in use.
    controller : ImpedanceControllerSpec
        With bounds and weights.
    """
    contact = plant.environment(controller.environment).nominal
    return ImpedanceProblem(
        loop=ImpedanceLoop(to_transfer_function(loop), contact),
        desired=desired_impedance(spec, controller),
        bandwidth=spec.limits.bandwidth.si,
        mass_bounds=(controller.Mt.min.si, controller.Mt.max.si),
        damping_bounds=(controller.Bt.min.si, controller.Bt.max.si),
        weight_displayed=float(controller.weights.displayed),
        weight_sensitivity=float(controller.weights.sensitivity),
    )


def _motion(spec: InteractionDesignSpec) -> ProportionalDerivative:
    given, digits = spec.motion_loop, spec.design.significant_digits
    wanted = root_locus_design(spec)
    gain = given.derivative_gain
    Kd = round_significant(wanted.derivative_gain, digits) if gain is None else gain.exact
    zero = round_significant(wanted.zero, digits) if given.zero is None else given.zero.exact
    shipped = to_float32(Kd)
    motion = ProportionalDerivative(Kp=to_float32(shipped * zero), Kd=shipped)
    if motion.Kp <= 0 or motion.Kd <= 0:
        raise DesignError(
            "a gain of the motion controller is zero in single precision",
            remedy="ask for a larger derivative gain or zero, or a shorter settling time",
            at=("motion_loop",),
        )
    return motion


def _controller(
    spec: InteractionDesignSpec,
    plant: Plant,
    loop: MotionLoop,
    name: str,
    controller: ImpedanceControllerSpec | ForceControllerSpec | PositionControllerSpec,
) -> Controller:
    if isinstance(controller, PositionControllerSpec):
        return Controller(name, PositionControl(), None, ())
    digits = spec.design.significant_digits
    law: Admittance | ProportionalForce
    optimum = None
    if isinstance(controller, ForceControllerSpec):
        law = ProportionalForce(_force_gain(plant, loop, controller, digits))
    elif controller.Mt.fixed and controller.Bt.fixed:
        # Nothing to choose; whether these gains are stable is for the certificate to say.
        law = Admittance(to_float32(controller.Mt.min.exact), to_float32(controller.Bt.min.exact))
        _check_ranges(controller, law)
    else:
        law, optimum = _admittance(spec, plant, loop, controller)
        _check_ranges(controller, law)
    return Controller(name, law, controller.environment, controller.contacts, optimum)


def _admittance(
    spec: InteractionDesignSpec, plant: Plant, loop: MotionLoop, controller: ImpedanceControllerSpec
) -> tuple[Admittance, ImpedanceOptimum]:
    """Optimize an admittance under its goals, and round it so that they are still met."""
    problem = impedance_problem(spec, plant, loop, controller)
    requirement = requirement_of(spec, plant, problem.loop.motion, controller)
    optimum = optimize_with_goals(problem, requirement)
    digits = spec.design.significant_digits
    law = Admittance(
        Mt=_shipped(optimum.Mt, controller.Mt, digits),
        Bt=_shipped(optimum.Bt, controller.Bt, digits),
    )
    if not meets(requirement, float(law.Mt), float(law.Bt)):
        law = _rounded_within(problem, requirement, optimum, controller, digits)
    return law, optimum


def _rounded_within(
    problem: ImpedanceProblem,
    requirement: Requirement,
    optimum: ImpedanceOptimum,
    controller: ImpedanceControllerSpec,
    digits: int,
) -> Admittance:
    """Round an optimum at the edge of what its goals allow: a gain may have to go the other way."""
    candidates = tuple(
        {float(_shipped(near, bounds, digits)) for near in neighbors(value, digits)}
        for value, bounds in ((optimum.Mt, controller.Mt), (optimum.Bt, controller.Bt))
    )
    pair = best_rounding(problem, requirement, (candidates[0], candidates[1]))
    if pair is None:
        raise DesignError(
            f"no gains of {digits} significant digits near Mt = {optimum.Mt:.6g} kg m^2 and "
            f"Bt = {optimum.Bt:.6g} N m s/rad meet the goals",
            remedy="raise design.significant_digits (at most 7), or relax a goal",
        )
    return Admittance(*map(Fraction, pair))


def _force_gain(
    plant: Plant, loop: MotionLoop, controller: ForceControllerSpec, digits: int
) -> Fraction:
    if controller.proportional_gain is not None:
        return to_float32(controller.proportional_gain.exact)
    stiffness = plant.environment(controller.environment).nominal.stiffness
    wanted = float(controller.damping_ratio or 0)
    gain = design_force_gain(to_transfer_function(loop), stiffness, wanted)
    return to_float32(round_significant(gain, digits))


def _check_ranges(controller: ImpedanceControllerSpec, law: Admittance) -> None:
    for gain, outside in faults_of_ranges(controller, {"Mt": law.Mt, "Bt": law.Bt}):
        remedy = "move the range, or let min and max lie inside it"
        raise DesignError(outside, remedy=remedy, at=(gain, "range"))


def _shipped(value: float, bounds: GainSpec, digits: int) -> Fraction:
    """Round a gain, keep it within its bounds, and round it to single precision."""
    rounded = round_significant(value, digits)
    return to_float32(min(max(rounded, bounds.min.exact), bounds.max.exact))
