"""The law that ships, as operations: from the same gains and the same sampling as the proof."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

from nrs_design.controllers.controller_design import SHARED_STATES, ControllerDesign
from nrs_design.controllers.float32 import float32_not_above
from nrs_design.controllers.gains import idle_share
from nrs_design.controllers.operations import StepLaw
from nrs_design.controllers.parts import DEFAULT_LIMIT
from nrs_design.controllers.step_analysis import check_range
from nrs_design.controllers.step_law import StepFrame, StepLimits, build_law
from nrs_design.controllers.step_logic import StepLogic
from nrs_design.errors import DesignError
from nrs_design.models.axis import AxisType
from nrs_design.spec import InteractionDesignSpec


def shipped_law(
    spec: InteractionDesignSpec,
    design: ControllerDesign,
    period: Fraction,
    outer: Fraction | None = None,
) -> StepLaw:
    """Write the law of a design out for a sample time in s.

    `outer` is that of force, filter and admittance. A `DesignError` if a controller has no step, or
    a step could leave single precision.
    """
    outer, filter_, motion = outer or period, design.sensor.filter, design.motion
    method = "exact" if spec.sampling is None else spec.sampling.admittance
    laws = {c.name: c.law.discretize(outer, method) for c in design.controllers}
    low_pass = None if filter_ is None else filter_.discretize(outer)
    frame = StepFrame(
        motion.Kp, motion.difference_gain(period), low_pass, step_limits(spec), design.takes
    )
    _check_states(spec, design)
    idle = None
    if spec.idle_states is not None:
        # A reset sets idle states to zero at the switch: a decay factor of zero does the same.
        idle = Fraction(0) if spec.idle_states.reset else idle_share(spec.idle_states, period)
    law = build_law(frame, laws, idle)
    check_range(law)
    law = _convert_units(law, design.axis, design.command)
    logic = spec.mode_logic
    return replace(law, logic=None if logic is None else StepLogic.create(logic, law.modes, period))


def _check_states(spec: InteractionDesignSpec, design: ControllerDesign) -> None:
    """Refuse controllers whose states no program has."""
    if spec.offset != "none":
        first = next(c.name for c in design.controllers if c.law.commands == "position")
        because = "it jumps at every switch, and no proof of a law in steps covers that"
        raise DesignError(
            f"force control takes an offset, of which there is no program: {because}",
            remedy="export the gains alone, with --format json",
            at=("controllers", first),
        )
    if (odd := design.find_odd_states(is_mixture=spec.idle_states is not None)) is not None:
        raise DesignError(odd, remedy=SHARED_STATES, at=("controllers",))


def _convert_units(law: StepLaw, axis: AxisType, command: str) -> StepLaw:
    """Name the units of an axis and of what the motor takes, where the law says rad and rpm."""

    def convert(unit: str) -> str:
        unit = axis.unit(unit)
        return command + unit.removeprefix("rpm") if unit.startswith("rpm") else unit

    return replace(
        law,
        inputs=tuple(replace(one, unit=convert(one.unit)) for one in law.inputs),
        states=tuple(replace(one, unit=convert(one.unit)) for one in law.states),
        coefficients=tuple(replace(one, unit=convert(one.unit)) for one in law.coefficients),
        units={name: convert(unit) for name, unit in law.units.items()},
    )


def step_limits(spec: InteractionDesignSpec) -> StepLimits:
    """Return the limits of a spec in single precision, none of them above what is written."""
    angle, command = DEFAULT_LIMIT, spec.limits.command
    if spec.disturbances is not None and spec.disturbances.largest_angle is not None:
        angle = float32_not_above(spec.disturbances.largest_angle.not_above)
    return StepLimits(
        angle,
        float32_not_above(spec.limits.velocity.not_above),
        None if command is None else float32_not_above(command.not_above),
        None if spec.anti_windup is None else float32_not_above(spec.anti_windup.clamp.not_above),
    )
