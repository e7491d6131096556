"""The law that ships, as operations: from the same gains and the same sampling as the proof."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction

from nrs_design.axis import AxisType
from nrs_design.controllers.controller_design import SHARED_STATES, ControllerDesign
from nrs_design.controllers.float32 import float32_not_above
from nrs_design.controllers.gains import idle_share
from nrs_design.controllers.laws import DiscreteLaw
from nrs_design.controllers.operations import StepLaw
from nrs_design.controllers.parts import BEYOND
from nrs_design.controllers.step_analysis import check_range
from nrs_design.controllers.step_law import StepFrame, StepLimits, build_law
from nrs_design.controllers.step_logic import StepLogic
from nrs_design.errors import DesignError
from nrs_design.spec import IdleStatesSpec, InteractionDesignSpec


def shipped_law(
    spec: InteractionDesignSpec,
    design: ControllerDesign,
    period: Fraction,
    outer: Fraction | None = None,
) -> StepLaw:
    """Write the law of a design out for a sample time in s.

    `outer` is that of force, filter and admittance, where it is another: whoever runs the
    operations of either loop takes them at its own samples. A `DesignError` if a controller has no
    step yet, or a step could leave single precision.
    """
    method = "exact" if spec.sampling is None else spec.sampling.admittance
    laws = {c.name: c.law.discretize(outer or period, method) for c in design.controllers}
    law = _step_law(spec, design, laws, period, outer or period)
    check_range(law)
    law = _in_commands(_on_axis(law, design.axis), design.command)
    return replace(law, logic=_logic_of(spec, law, period))


def _logic_of(spec: InteractionDesignSpec, law: StepLaw, period: Fraction) -> StepLogic | None:
    """Return the mode logic that ships."""
    logic = spec.mode_logic
    return None if logic is None else StepLogic.of(logic, law.modes, period)


def _step_law(
    spec: InteractionDesignSpec,
    design: ControllerDesign,
    laws: Mapping[str, DiscreteLaw],
    period: Fraction,
    outer: Fraction,
) -> StepLaw:
    low_pass = None if design.sensor.filter is None else design.sensor.filter.discretize(outer)
    motion = design.motion
    frame = StepFrame(motion.Kp, motion.over(period), low_pass, step_limits(spec), design.takes)
    if spec.offset != "none":
        first = next(c.name for c in design.controllers if c.law.commands == "position")
        because = "it jumps at every switch, and no proof of a law in steps covers that"
        raise DesignError(
            f"force control takes an offset, of which there is no program: {because}",
            remedy="export the gains alone, with --format json",
            at=("controllers", first),
        )
    if (odd := design.find_odd_states(mixed=spec.idle_states is not None)) is not None:
        raise DesignError(odd, remedy=SHARED_STATES, at=("controllers",))
    idle = spec.idle_states
    return build_law(frame, laws, None if idle is None else _left(idle, period))


def _left(idle: IdleStatesSpec, period: Fraction) -> Fraction:
    """Return what a sample leaves of idle states.

    A reset sets them to zero at the switch, and what decays from zero stays there: to leave nothing
    of them from the first sample on is the same.
    """
    return Fraction(0) if idle.reset else idle_share(idle, period)


def _in_commands(law: StepLaw, command: str) -> StepLaw:
    """Name the unit that the motor takes, where the law says rpm; its numbers are in it already."""
    units = {name: _renamed(unit, command) for name, unit in law.units.items()}
    coefficients = tuple(replace(c, unit=_renamed(c.unit, command)) for c in law.coefficients)
    return replace(law, units=units, coefficients=coefficients)


def _on_axis(law: StepLaw, axis: AxisType) -> StepLaw:
    """Name the units of an axis where the law says those of one that turns."""
    inputs, states = (
        tuple(replace(v, unit=axis.unit(v.unit)) for v in values)
        for values in (law.inputs, law.states)
    )
    coefficients = tuple(replace(c, unit=axis.unit(c.unit)) for c in law.coefficients)
    units = {name: axis.unit(unit) for name, unit in law.units.items()}
    return replace(law, inputs=inputs, states=states, coefficients=coefficients, units=units)


def _renamed(unit: str, command: str) -> str:
    return command + unit.removeprefix("rpm") if unit.startswith("rpm") else unit


def step_limits(spec: InteractionDesignSpec) -> StepLimits:
    """Return the limits of a spec in single precision, none of them above what is written."""
    angle, command = BEYOND, spec.limits.command
    if spec.disturbances is not None and spec.disturbances.largest_angle is not None:
        angle = float32_not_above(spec.disturbances.largest_angle.not_above)
    return StepLimits(
        angle,
        float32_not_above(spec.limits.velocity.not_above),
        None if command is None else float32_not_above(command.not_above),
        None if spec.anti_windup is None else float32_not_above(spec.anti_windup.clamp.not_above),
    )
