"""What a spec says, quantity by quantity, as written and in SI."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import TYPE_CHECKING, NamedTuple

from nrs_design.proof.text import exact_text
from nrs_design.spec import kinds
from nrs_design.spec.controllers import (
    ControllerSpec,
    contact_names,
)
from nrs_design.spec.environment import AbstractEnvironmentSpec, EnvironmentSpec, unit_at_pivot
from nrs_design.spec.gain_fields import GainSpec
from nrs_design.spec.goals import GoalsSpec
from nrs_design.spec.interaction import InteractionDesignSpec
from nrs_design.spec.model import SpecModel
from nrs_design.spec.motion import ActuatorSpec, LimitsSpec
from nrs_design.spec.parameters import ParameterSpec
from nrs_design.spec.provenance import COVERS, MOTOR_COVERS, IdentifiedSpec
from nrs_design.spec.quantity import Quantity, QuantityKind
from nrs_design.spec.quantity_fields import RangedQuantity
from nrs_design.spec.robot import RobotSpec
from nrs_design.spec.sampling import SamplingSpec
from nrs_design.spec.switched_system import SwitchedSystemSpec
from nrs_design.spec.switching import SwitchingSpec
from nrs_design.spec.units import BASE_UNITS, THESIS_COMMAND

if TYPE_CHECKING:
    from nrs_design.spec.load import Spec

MAX_LISTED = 20
# Keys of a controller that are listed in a way of their own, and the kinds of gains.
_TARGETS = frozenset({"desired_impedance", "desired_impedance_ratio"})
_LISTED = _TARGETS | {"type", "environment", "contacts", "goals"}
_SHOWN = (
    kinds.INERTIA,
    kinds.IMPEDANCE,
    kinds.SPRING,
    kinds.FORCE_GAIN,
    kinds.TORQUE,
    kinds.TORQUE_RATE,
)


class Line(NamedTuple):
    """One line of the listing."""

    name: str
    written: str
    value: str
    unit: str


def describe(spec: Spec) -> tuple[Line, ...]:
    """List what a spec says.

    Parameters
    ----------
    spec : InteractionDesignSpec, SwitchedSystemSpec or RobotSpec
        A validated spec.

    Returns
    -------
    tuple of Line
        Name, text as written, SI value and SI unit. Linear stiffness is shown at the pivot.
    """
    if isinstance(spec, SwitchedSystemSpec):
        return tuple(_modes(spec))
    if isinstance(spec, RobotSpec):
        return tuple(describe_model(spec))
    return tuple(_interaction(spec))


def _modes(spec: SwitchedSystemSpec) -> Iterator[Line]:
    yield Line("time", spec.time, "", "")
    yield from _switching(spec.switching)
    for name, parameter in spec.parameters.items():
        yield from _parameter(f"parameters.{name}", parameter)
    unit = "1/s" if spec.time == "continuous" else ""
    for index, mode in enumerate(spec.modes):
        n = mode.dimension
        depends = f"{n} x {n}" + "".join(f", {name}" for name in sorted(mode.parameters))
        yield Line(f"modes[{index}]", mode.name, depends, unit)
    for index, reset in enumerate(spec.resets):
        shape = f"{reset.shape[0]} x {reset.shape[1]}"
        yield Line(f"resets[{index}]", f"{reset.source} to {reset.target}", shape, "")


def _parameter(name: str, parameter: ParameterSpec) -> Iterator[Line]:
    yield _number(name, parameter.nominal)
    if not parameter.fixed:
        yield _coefficients(f"{name}.range", parameter.range)
        change = "arbitrarily fast" if parameter.varies else "unknown, but constant"
        yield Line(f"{name}.varies", str(parameter.varies).lower(), change, "")


def _switching(switching: SwitchingSpec) -> Iterator[Line]:
    if switching.is_arbitrary:
        yield Line("switching", str(switching), "", "")
    for at, dwell in switching.dwell_times():
        name = ".".join(("switching", *at))
        yield Line(name, dwell.text, _text(float(dwell.value)), dwell.unit)
    if switching.transitions is not None:
        pairs = [f"{source} to {target}" for source, target in switching.transitions]
        listed = ", ".join(pairs[:MAX_LISTED]) + ", ..." * (len(pairs) > MAX_LISTED)
        yield Line("switching.transitions", listed or "no switch", str(len(pairs)), "")


def _interaction(spec: InteractionDesignSpec) -> Iterator[Line]:
    yield from _actuator(spec.actuator)
    yield from _motion_loop(spec)
    yield from _limits(spec.limits)
    for name, environment in spec.environments.items():
        yield from _environment(f"environments.{name}", environment)
    for name, controller in spec.controllers.items():
        yield from _controller(f"controllers.{name}", controller, spec.limits)
    if spec.idle_states is not None:
        yield from describe_model(spec.idle_states, "idle_states")
    yield from _goals("goals", spec.goals)
    yield Line("design.significant_digits", str(spec.design.significant_digits), "", "")
    if spec.sampling is not None:
        yield from _sampling(spec.sampling)
    if spec.disturbances is not None:
        yield from describe_model(spec.disturbances, "disturbances")
    yield from describe_model(spec.coupling, "coupling")
    yield from describe_model(spec.sensor, "sensor")
    if spec.mode_logic is not None:
        yield from describe_model(spec.mode_logic, "mode_logic")
    for name, scenario in spec.scenarios.items():
        yield from describe_model(scenario, f"scenarios.{name}")
    yield Line("contact", spec.contact or "not said: the claim tells", "", "")
    yield Line("coordinates", spec.coordinates, "", "")
    yield from _switching(spec.switching)


def _actuator(actuator: ActuatorSpec) -> Iterator[Line]:
    if actuator.command != THESIS_COMMAND:
        yield Line("actuator.command", actuator.command, "", "")
    for name, kind in (("gain", kinds.ACTUATOR_GAIN), ("time_constant", kinds.DURATION)):
        written = getattr(actuator, name)
        unit = kind.unit_in(written.nominal.dimension)
        yield from _ranged(f"actuator.{name}", written, written, unit)
    if actuator.range_covers is not None:
        covered = MOTOR_COVERS[actuator.range_covers]
        yield Line("actuator.range_covers", actuator.range_covers, covered, "")
    if actuator.load_inertia is not None:
        yield _row("actuator.load_inertia", actuator.load_inertia, kinds.INERTIA)
    if actuator.intervals is not None:
        for name in ("gain", "time_constant"):
            low, high = getattr(actuator.intervals, name)
            yield Line(f"actuator.intervals.{name}", f"[{low.text}, {high.text}]", "", "")
    yield from _provenance("actuator", actuator)


def _limits(limits: LimitsSpec) -> Iterator[Line]:
    yield _row("limits.velocity", limits.velocity, kinds.ANGULAR_VELOCITY)
    yield _row("limits.torque", limits.torque, kinds.TORQUE)
    yield _row("limits.bandwidth", limits.bandwidth, kinds.BANDWIDTH)
    if limits.command is not None:
        unit = kinds.COMMAND.unit_in(limits.command.dimension)
        yield _quantity("limits.command", limits.command, unit)


def _sampling(sampling: SamplingSpec) -> Iterator[Line]:
    yield _row("sampling.period", sampling.period, kinds.DURATION)
    if sampling.outer_period is not None:
        yield _row("sampling.outer_period", sampling.outer_period, kinds.DURATION)
    least, most = sampling.delay
    delay = str(least) if least == most else f"[{least}, {most}]"
    yield Line("sampling.delay", delay, "", "samples")
    yield Line("sampling.admittance", sampling.admittance, "", "")
    yield from _provenance("sampling", sampling)


def _motion_loop(spec: InteractionDesignSpec) -> Iterator[Line]:
    loop = spec.motion_loop
    yield _number("motion_loop.damping_ratio", loop.damping_ratio)
    yield _row("motion_loop.settling_time", loop.settling_time, kinds.DURATION)
    if loop.derivative_gain is not None:
        unit = kinds.DERIVATIVE_GAIN.unit_in(loop.derivative_gain.dimension)
        yield _quantity("motion_loop.derivative_gain", loop.derivative_gain, unit)
    if loop.zero is not None:
        yield _row("motion_loop.zero", loop.zero, kinds.ZERO)
    if loop.transfer_function is not None:
        tf = loop.transfer_function
        yield _coefficients("motion_loop.transfer_function.numerator", tf.numerator)
        yield _coefficients("motion_loop.transfer_function.denominator", tf.denominator)


def _environment(name: str, environment: EnvironmentSpec) -> Iterator[Line]:
    yield Line(f"{name}.model", environment.model, "", "")
    turned = environment.at_pivot()
    parameters = environment.parameters()
    for key, written in parameters.items():
        unit = unit_at_pivot(written.nominal)
        yield from _ranged(f"{name}.{key}", written, turned[key], unit)
    for key in type(environment).model_fields:
        if key not in parameters and key not in AbstractEnvironmentSpec.model_fields:
            yield from describe_model(getattr(environment, key), f"{name}.{key}")
    if environment.preloaded:
        yield from _over_preload(name, environment)
    if environment.lever_arm is not None:
        yield _row(f"{name}.lever_arm", environment.lever_arm, kinds.LEVER_ARM)
    if environment.range_covers is not None:
        covered = COVERS[environment.range_covers]
        yield Line(f"{name}.range_covers", environment.range_covers, covered, "")
    if environment.linearized_about is not None:
        yield Line(f"{name}.linearized_about", environment.linearized_about, "", "")
    yield from _provenance(name, environment)


def _over_preload(name: str, environment: EnvironmentSpec) -> Iterator[Line]:
    """List where stiffness and damping of a power law are over its preload, at the pivot."""
    for key, interval in environment.linear_at_pivot().items():
        unit = unit_at_pivot(getattr(environment, key).nominal)
        value = f"[{_text(float(interval.low))}, {_text(float(interval.high))}]"
        yield Line(f"{name}.{key} over the preload", "", value, unit)


def _provenance(name: str, identified: IdentifiedSpec) -> Iterator[Line]:
    for index, source in enumerate(identified.provenance):
        yield Line(f"{name}.provenance[{index}]", source.file, source.data, "")
    for index, doubt in enumerate(identified.doubts):
        yield Line(f"{name}.doubts[{index}]", doubt, "", "")
    if identified.accept_doubt is not None:
        yield Line(f"{name}.accept_doubt", identified.accept_doubt, "", "")


def _ranged(name: str, written: RangedQuantity, si: RangedQuantity, unit: str) -> Iterator[Line]:
    yield Line(name, written.nominal.text, _text(si.nominal.si), unit)
    if not written.fixed:
        (low, high), (si_low, si_high) = written.range, si.range
        value = f"[{_text(si_low.si)}, {_text(si_high.si)}]"
        yield Line(f"{name}.range", f"[{low.text}, {high.text}]", value, unit)


def _controller(name: str, controller: ControllerSpec, limits: LimitsSpec) -> Iterator[Line]:
    yield Line(f"{name}.type", controller.type, "", "")
    if controller.environment is None:
        return
    yield Line(f"{name}.environment", controller.environment, "", "")
    yield Line(f"{name}.contacts", ", ".join(contact_names(controller.contacts)), "", "")
    if controller.displayed is not None:
        yield _desired_impedance(f"{name}.desired_impedance", controller.displayed, limits)
    for key in type(controller).model_fields:
        if key not in _LISTED:
            yield from _own_field(f"{name}.{key}", getattr(controller, key))
    yield from _goals(f"{name}.goals", controller.goals)


def _own_field(name: str, value: object) -> Iterator[Line]:
    """List what only one type of controller has."""
    if isinstance(value, GainSpec):
        yield from _gain(name, value, _shown_unit(value.min))
    elif isinstance(value, Quantity):
        yield _quantity(name, value, _shown_unit(value))
    else:
        yield from describe_model(value, name)


def _shown_unit(quantity: Quantity) -> str:
    """Return the unit in which a gain, or a signal, is shown."""
    known = (kind.si_unit for kind in _SHOWN if kind.accepts(quantity.dimension))
    return next(known, si_unit(quantity.dimension))


def _goals(name: str, goals: GoalsSpec | None) -> Iterator[Line]:
    if goals is not None:
        yield from describe_model(goals, name)


def _desired_impedance(name: str, displayed: Quantity | Fraction, limits: LimitsSpec) -> Line:
    if isinstance(displayed, Quantity):
        return _row(name, displayed, kinds.IMPEDANCE)
    written = "torque/velocity" if displayed == 1 else f"{exact_text(displayed)} * torque/velocity"
    value = float(displayed) * limits.torque.si / limits.velocity.si
    return Line(name, written, _text(value), kinds.IMPEDANCE.si_unit)


def _gain(name: str, gain: GainSpec, unit: str) -> Iterator[Line]:
    if gain.fixed:
        yield _quantity(name, gain.min, unit)
    else:
        yield _interval(name, gain.min, gain.max, unit)
    if gain.range is not None:
        yield _interval(f"{name}.range", *gain.range, unit)


def _interval(name: str, low: Quantity, high: Quantity, unit: str) -> Line:
    value = f"[{_text(low.si)}, {_text(high.si)}]"
    return Line(name, f"[{low.text}, {high.text}]", value, unit)


def _row(name: str, quantity: Quantity, kind: QuantityKind) -> Line:
    return _quantity(name, quantity, kind.si_unit)


def _quantity(name: str, quantity: Quantity, unit: str) -> Line:
    return Line(name, quantity.text, _text(quantity.si), unit)


def _number(name: str, number: Fraction) -> Line:
    return Line(name, exact_text(number), _text(float(number)), "")


def _coefficients(name: str, numbers: tuple[Fraction, ...]) -> Line:
    value = ", ".join(_text(float(number)) for number in numbers)
    return Line(name, f"[{', '.join(map(exact_text, numbers))}]", f"[{value}]", "")


def describe_model(value: object, name: str = "") -> Iterator[Line]:
    """List every value of a model whose quantities need no conversion but that to SI."""
    if isinstance(value, SpecModel):
        for field in type(value).model_fields:
            if name or field not in ("kind", "name", "title"):
                yield from describe_model(getattr(value, field), f"{name}.{field}".lstrip("."))
    elif isinstance(value, dict):
        for key, item in value.items():
            yield from describe_model(item, f"{name}.{key}")
    elif isinstance(value, tuple):
        for index, item in enumerate(value):
            yield from describe_model(item, f"{name}[{index}]")
    elif isinstance(value, Quantity):
        yield Line(name, value.text, _text(value.si), _shown_unit(value))
    elif isinstance(value, Fraction):
        yield _number(name, value)
    elif isinstance(value, bool):
        yield Line(name, str(value).lower(), "", "")
    elif value is not None:
        yield Line(name, str(value), "", "")


def si_unit(dimension: tuple[int, ...]) -> str:
    """Write a dimension as a product of SI units."""
    powers = dict(zip(BASE_UNITS, dimension, strict=True))
    above = "*".join(_power(unit, power) for unit, power in powers.items() if power > 0)
    below = "".join(f"/{_power(unit, -power)}" for unit, power in powers.items() if power < 0)
    return (above or "1") + below


def _power(unit: str, power: int) -> str:
    return unit if power == 1 else f"{unit}^{power}"


def _text(value: float) -> str:
    return f"{value:.6g}"
