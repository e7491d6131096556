"""Choose every gain of an interaction design, rounded to the numbers that ship."""

from __future__ import annotations

from nrs_design.controllers.controller_design import Controller, ControllerDesign
from nrs_design.controllers.float32 import round_significant, to_float32
from nrs_design.controllers.laws import NO_MOTION, ProportionalDerivative
from nrs_design.design.laws import LAW_DESIGNS
from nrs_design.design.laws.law import Task, naming
from nrs_design.design.root_locus import PdDesign, design_pd
from nrs_design.errors import DesignError
from nrs_design.models.plant import Plant
from nrs_design.spec import InteractionDesignSpec
from nrs_design.spec.controllers import contact_names


def design_controllers(spec: InteractionDesignSpec, plant: Plant) -> ControllerDesign:
    """Choose the motion gains by root locus, then every compliant controller on top of them."""
    motion = _motion(spec)
    task = Task(spec, plant, motion)
    controllers = []
    for name, given in spec.controllers.items():
        with naming(name):
            law, optimum = LAW_DESIGNS[given.type].choose(task, given)
        controllers.append(
            Controller(name, law, given.environment, contact_names(given.contacts), optimum)
        )
    return ControllerDesign(motion, tuple(controllers), task.sensor, spec.command, spec.axis)


def root_locus_design(spec: InteractionDesignSpec) -> PdDesign | None:
    """Return the PD that the root locus asks for, before any rounding or given value.

    None where the robot closes its own motion loop.
    """
    motor, loop = spec.actuator, spec.motion_loop
    if motor is None or loop is None:
        return None
    return design_pd(
        motor.gain.nominal.si,
        motor.time_constant.nominal.si,
        float(loop.damping_ratio),
        loop.settling_time.si,
    )


def _motion(spec: InteractionDesignSpec) -> ProportionalDerivative:
    given, digits = spec.motion_loop, spec.design.significant_digits
    wanted = root_locus_design(spec)
    if wanted is None or given is None:
        return NO_MOTION
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
