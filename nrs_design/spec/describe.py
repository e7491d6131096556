"""What a spec says, quantity by quantity, as written and in SI."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import TYPE_CHECKING, NamedTuple

from nrs_design.models.axis import current
from nrs_design.models.interval import Interval
from nrs_design.proof.text import exact_text
from nrs_design.spec import kinds
from nrs_design.spec.controllers import ControllerSpec, contact_names
from nrs_design.spec.environment import AbstractEnvironmentSpec, unit_at_pivot
from nrs_design.spec.interaction import InteractionDesignSpec
from nrs_design.spec.misses import DeadlinesSpec
from nrs_design.spec.model import SpecModel
from nrs_design.spec.motion import LimitsSpec
from nrs_design.spec.provenance import COVERS, MOTOR_COVERS, ProvenanceSpec
from nrs_design.spec.quantity import Quantity
from nrs_design.spec.quantity_fields import GainSpec, RangedQuantity, Times
from nrs_design.spec.robot import RobotSpec
from nrs_design.spec.switched_system import SwitchedSystemSpec
from nrs_design.spec.switching import SwitchingSpec
from nrs_design.spec.units import BASE_UNITS, THESIS_COMMAND

if TYPE_CHECKING:
    from nrs_design.spec.load import Spec

MAX_LISTED = 20
# Keys of a controller that are listed in a way of their own.
_LISTED = frozenset(
    ["type", "environment", "contacts", "desired_impedance", "desired_impedance_ratio", "goals"]
)
# Sections after the controllers, and after the notes of identification.
_OTHERS = (
    *("idle_states", "anti_windup", "goals", "design", "sampling", "disturbances", "sensor"),
    *("monitoring", "mode_logic", "scenarios"),
)
_IDENTIFIED = (
    *("range_covers", "range_id", "linearized_about", "provenance", "doubts", "accept_doubt"),
)
_SHOWN = (
    kinds.INERTIA,
    kinds.IMPEDANCE,
    kinds.SPRING,
    kinds.FORCE_GAIN,
    kinds.TORQUE,
    kinds.TORQUE_RATE,
    kinds.LINEAR_STIFFNESS,
)


class Line(NamedTuple):
    """One line of the listing."""

    name: str
    written: str
    value: str = ""
    unit: str = ""


def describe(spec: Spec) -> tuple[Line, ...]:
    """List the lines of a spec: name, text as written, SI value and SI unit.

    Linear stiffness is shown at the pivot.
    """
    if isinstance(spec, SwitchedSystemSpec):
        return tuple(_modes(spec))
    if isinstance(spec, RobotSpec):
        return tuple(describe_model(spec))
    return tuple(_interaction(spec))


def _modes(spec: SwitchedSystemSpec) -> Iterator[Line]:
    yield Line("time", spec.time)
    yield from _switching(spec.switching)
    for name, parameter in spec.parameters.items():
        yield _number(f"parameters.{name}", parameter.nominal)
        if not parameter.fixed:
            yield _coefficients(f"parameters.{name}.range", parameter.range)
            change = "arbitrarily fast" if parameter.varies else "unknown, but constant"
            yield Line(f"parameters.{name}.varies", str(parameter.varies).lower(), change)
    unit = "1/s" if spec.time == "continuous" else ""
    for index, mode in enumerate(spec.modes):
        n = mode.dimension
        depends = f"{n} x {n}" + "".join(f", {name}" for name in sorted(mode.parameters))
        yield Line(f"modes[{index}]", mode.name, depends, unit)
    for index, reset in enumerate(spec.resets):
        shape = f"{reset.shape[0]} x {reset.shape[1]}"
        yield Line(f"resets[{index}]", f"{reset.source} to {reset.target}", shape)


def _switching(switching: SwitchingSpec) -> Iterator[Line]:
    if switching.is_arbitrary:
        yield Line("switching", str(switching))
    for at, dwell in switching.dwell_times():
        name = ".".join(("switching", *at))
        yield Line(name, dwell.text, _text(float(dwell.value)), dwell.unit)
    if switching.transitions is not None:
        pairs = [f"{source} to {target}" for source, target in switching.transitions]
        listed = ", ".join(pairs[:MAX_LISTED]) + ", ..." * (len(pairs) > MAX_LISTED)
        yield Line("switching.transitions", listed or "no switch", str(len(pairs)))


def _interaction(spec: InteractionDesignSpec) -> Iterator[Line]:
    for key in (*spec.drives, "motion_loop", "limits", "environments"):
        yield from describe_model(getattr(spec, key), key)
    for name, controller in spec.controllers.items():
        yield from _controller(f"controllers.{name}", controller, spec.limits)
    for key in _OTHERS:
        yield from describe_model(getattr(spec, key), key)
    yield Line("contact", spec.contact or "not said: the claim tells")
    yield from _switching(spec.switching)


def _environment(name: str, environment: AbstractEnvironmentSpec) -> Iterator[Line]:
    yield Line(f"{name}.model", environment.model)
    turned = environment.exact_at_pivot()
    parameters = environment.ranges
    for key, written in parameters.items():
        unit = unit_at_pivot(written.nominal)
        yield from _ranged(f"{name}.{key}", written, turned[key], unit)
    for key in type(environment).model_fields:
        if key not in parameters and key not in AbstractEnvironmentSpec.model_fields:
            yield from describe_model(getattr(environment, key), f"{name}.{key}")
    # Ranges of stiffness and damping of a power law over its preload, at the pivot.
    for key, interval in environment.linear_at_pivot().items() if environment.preloaded else ():
        unit = unit_at_pivot(parameters[key].nominal)
        value = _ends(float(interval.low), float(interval.high))
        yield Line(f"{name}.{key} over the preload", "", value, unit)
    yield from describe_model(environment.lever_arm, f"{name}.lever_arm")
    yield from _identified(name, environment)


def _identified(name: str, item: SpecModel) -> Iterator[Line]:
    """List the identified values with their sources and qualities."""
    covers = COVERS if isinstance(item, AbstractEnvironmentSpec) else MOTOR_COVERS
    for key in (key for key in _IDENTIFIED if key in type(item).model_fields):
        value = getattr(item, key)
        if key == "range_covers" and value is not None:
            yield Line(f"{name}.{key}", value, covers[value])
        elif key != "range_id":
            yield from describe_model(value, f"{name}.{key}")


def _ranged(name: str, written: RangedQuantity, si: Interval, unit: str) -> Iterator[Line]:
    yield Line(name, written.nominal.text, _text(float(si.nominal)), unit)
    if not written.fixed:
        low, high = written.range
        value = _ends(float(si.low), float(si.high))
        yield Line(f"{name}.range", f"[{low.text}, {high.text}]", value, unit)
    if not written.varies:
        yield Line(f"{name}.varies", "false", "unknown, but constant")


def _ends(low: float, high: float) -> str:
    return f"[{_text(low)}, {_text(high)}]"


def _controller(name: str, controller: ControllerSpec, limits: LimitsSpec) -> Iterator[Line]:
    yield Line(f"{name}.type", controller.type)
    if controller.environment is None:
        return
    yield Line(f"{name}.environment", controller.environment)
    yield Line(f"{name}.contacts", ", ".join(contact_names(controller.contacts)))
    yield from _desired_impedance(f"{name}.desired_impedance", controller.displayed, limits)
    for key in type(controller).model_fields:
        if key not in _LISTED:
            yield from describe_model(getattr(controller, key), f"{name}.{key}")
    yield from describe_model(controller.goals, f"{name}.goals")


def _shown_unit(quantity: Quantity) -> str:
    """Return the unit in which a quantity is shown."""
    dimension = quantity.dimension
    gain, *shown = (kind.on(current()) for kind in (kinds.DERIVATIVE_GAIN, *_SHOWN))
    if gain.accepts(dimension):
        return gain.unit_in(dimension)
    known = (kind.si_unit for kind in shown if kind.accepts(dimension))
    return next(known, si_unit(dimension))


def _desired_impedance(
    name: str, displayed: Quantity | Fraction | None, limits: LimitsSpec
) -> Iterator[Line]:
    if not isinstance(displayed, Fraction):
        yield from describe_model(displayed, name)
        return
    written = "torque/velocity" if displayed == 1 else f"{exact_text(displayed)} * torque/velocity"
    value = float(displayed) * limits.torque.si / limits.velocity.si
    yield Line(name, written, _text(value), kinds.IMPEDANCE.on(current()).si_unit)


def _number(name: str, number: Fraction) -> Line:
    return Line(name, exact_text(number), _text(float(number)))


def _coefficients(name: str, numbers: tuple[Fraction, ...]) -> Line:
    value = ", ".join(_text(float(number)) for number in numbers)
    return Line(name, f"[{', '.join(map(exact_text, numbers))}]", f"[{value}]")


def describe_model(value: object, name: str = "") -> Iterator[Line]:
    """List every value of a part whose quantities need no conversion but that to SI."""
    if isinstance(value, AbstractEnvironmentSpec):
        yield from _environment(name, value)
    elif isinstance(value, RangedQuantity):
        yield from _ranged(name, value, value.interval, _shown_unit(value.nominal))
    elif isinstance(value, ProvenanceSpec):
        yield Line(name, value.file, value.data)
    elif isinstance(value, GainSpec):
        low, high, unit = value.min, value.max, _shown_unit(value.min)
        if value.fixed:
            yield Line(name, low.text, _text(low.si), unit)
        else:
            yield Line(name, f"[{low.text}, {high.text}]", _ends(low.si, high.si), unit)
    elif isinstance(value, Times):
        first, last = value.shortest.text, value.longest.text
        how = "unknown, but constant" if value.is_constant else ""
        yield Line(name, first if first == last else f"[{first}, {last}]", how)
    elif isinstance(value, DeadlinesSpec):
        yield Line(name, f"at most {value}", f"command: {value.command}, job: {value.job}")
    elif isinstance(value, SpecModel):
        hidden = () if name else ("kind", "name", "title")
        for field in type(value).model_fields:
            if field not in (*hidden, *_IDENTIFIED):
                yield from describe_model(getattr(value, field), f"{name}.{field}".lstrip("."))
        yield from _identified(name, value)
    elif isinstance(value, dict):
        for key, item in value.items():
            yield from describe_model(item, f"{name}.{key}")
    elif isinstance(value, tuple) and {*map(type, value)} == {Fraction}:
        yield _coefficients(name, value)
    elif isinstance(value, tuple) and {*map(type, value)} == {int}:
        least, most = value
        yield Line(name, str(least) if least == most else f"[{least}, {most}]", "", "samples")
    elif isinstance(value, tuple):
        for index, item in enumerate(value):
            yield from describe_model(item, f"{name}[{index}]")
    elif isinstance(value, Quantity):
        yield Line(name, value.text, _text(value.si), _shown_unit(value))
    elif isinstance(value, Fraction):
        yield _number(name, value)
    elif isinstance(value, bool):
        yield Line(name, str(value).lower())
    # The unit of commands where none is named.
    elif value not in (None, THESIS_COMMAND):
        yield Line(name, str(value))


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
