"""The motion loop below a safety layer, as a statement about the layer takes it."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

from nrs_design.controllers.controller_design import ControllerDesign
from nrs_design.controllers.float32 import float32_not_above, to_float32
from nrs_design.controllers.safety import SafetyLimits
from nrs_design.models.plant import Plant
from nrs_design.proof.saturation import Governed
from nrs_design.proof.system import SwitchedSystem
from nrs_design.spec.operating import OperatingConditions

ZERO = Fraction(0)


def with_safety(
    system: SwitchedSystem, conditions: OperatingConditions, plant: Plant, design: ControllerDesign
) -> SwitchedSystem:
    """Return a sampled loop with the safety layer of its spec, if it has one.

    Parameters
    ----------
    system : SwitchedSystem
        The modes, in which the layer is idle.
    conditions : OperatingConditions
        With the layer, the processor and what disturbs.
    plant : Plant
        Its motor.
    design : ControllerDesign
        Motion gains and sensor.
    """
    spec, sampling, angle = conditions.safety, conditions.sampling, conditions.largest_angle
    if spec is None or sampling is None or angle is None:
        return system
    period, largest = sampling.period.exact, conditions.largest_command
    limits = SafetyLimits.of(spec, period)
    motor, disturbances = plant.actuator_ranges, conditions.disturbances or {}
    bounds = {name: bound for name, (bound, _) in disturbances.items()}
    loop = Governed(
        (motor.gain.low, motor.gain.high),
        (motor.time_constant.low, motor.time_constant.high),
        design.motion.Kp,
        design.motion.over(period),
        to_float32(period),
        limits.speed,
        limits.torque,
        limits.energy,
        limits.refill,
        (spec.stiffness[0].exact, spec.stiffness[1].exact),
        sampling.delay[1],
        angle,
        conditions.command,
        bounds.get("encoder error", ZERO),
        bounds.get("force error", ZERO) + design.sensor.lasting,
        bounds.get("friction", ZERO),
        ZERO if spec.damping is None else spec.damping.exact,
        None if largest is None else float32_not_above(largest),
    )
    return replace(system, safety=loop)
