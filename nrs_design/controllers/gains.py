"""Gains as text: exact decimals of single-precision numbers, by controller."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction
from typing import TYPE_CHECKING

from nrs_design.controllers.controller_design import Controller, ControllerDesign
from nrs_design.controllers.float32 import exact_decimal, is_float32, round_float32
from nrs_design.controllers.laws import LAWS, NO_MOTION, ProportionalDerivative
from nrs_design.controllers.sensor import build_sensor
from nrs_design.controllers.taylor import exponential_between
from nrs_design.errors import CertificateError
from nrs_design.spec import (
    ControllerSpec,
    GainSpec,
    IdleStatesSpec,
    InteractionDesignSpec,
    parse_exact,
)
from nrs_design.spec.controllers import contact_names
from nrs_design.spec.interaction_parts import FactorBounds
from nrs_design.spec.quantity import exact_number

if TYPE_CHECKING:
    from nrs_design.spec import Spec

MOTION = ProportionalDerivative.name
# Goals that free gains are chosen by: numbers that a proof shows, and last what is proved about.
STEERING = ("decay_rate", "peak_torque", "delay")
# Gains by controller.
Numbers = Mapping[str, Mapping[str, Fraction]]


def gains_of(design: ControllerDesign) -> dict[str, dict[str, str]]:
    """Return every gain as an exact decimal, by controller name; the PD is ``motion``."""
    return {
        name: {gain: exact_decimal(value) for gain, value in law.gains.items()}
        for name, law in design.laws.items()
    }


def design_from_gains(
    spec: InteractionDesignSpec, gains: Mapping[str, Mapping[str, str]]
) -> ControllerDesign:
    """Rebuild a design from its gains, within what the spec allows.

    A `CertificateError` if one is missing, is no single-precision number, or is outside the bounds
    that the spec sets.
    """
    expected = {MOTION, *spec.controllers}
    if set(gains) != expected:
        raise CertificateError(f"its gains are not those of {', '.join(sorted(expected))}")
    numbers = {name: _numbers(spec, name, texts) for name, texts in gains.items()}
    given = _unfreed(spec, numbers)
    motion = _motion(spec, given)
    controllers = tuple(
        _controller(name, controller, given[name]) for name, controller in spec.controllers.items()
    )
    sensor = build_sensor(spec.sensor)
    found = ControllerDesign(motion, controllers, sensor, spec.command, spec.axis)
    return found.replace_gains(numbers)


def free_gains(spec: InteractionDesignSpec) -> Iterator[tuple[str, str]]:
    """Yield controller and gain name for every gain that the search may choose."""
    for name, controller in spec.controllers.items():
        yield from ((name, gain) for gain, bounds in controller.gains().items() if not bounds.fixed)
    for name, free in spec.design.free.items():
        yield from ((name, gain) for gain, _ in free.given())


def steering_goals(spec: Spec) -> tuple[str, ...]:
    """Return the goals of a spec that its free gains are chosen by; none where no gain is free."""
    if spec.kind != "interaction-design" or spec.goals is None:
        return ()
    given = {key for key, _ in spec.goals.given()}
    return tuple(key for key in STEERING if key in given) if any(free_gains(spec)) else ()


def apply_free_gains(
    spec: InteractionDesignSpec,
    design: ControllerDesign,
    gains: Mapping[str, Mapping[str, str]],
) -> ControllerDesign:
    """Return a design with the free gains of a certificate.

    A `CertificateError` if a gain is farther from the design than `design.free` allows.
    """
    found: dict[str, dict[str, Fraction]] = {}
    for name, gain in free_gains(spec):
        found.setdefault(name, {})[gain] = parse_exact(gains[name][gain])
    laws = design.laws
    for name, free in spec.design.free.items():
        for gain, factors in free.given():
            _check_near(name, gain, laws[name].gains[gain], factors, found[name][gain])
    return design.replace_gains(found)


def _check_near(
    name: str, gain: str, nominal: Fraction, factors: FactorBounds, value: Fraction
) -> None:
    low, high = (round_float32(factor * nominal) for factor in (factors.min, factors.max))
    if not low <= value <= high:
        raise CertificateError(f"gain {gain} of {name} is outside its bounds")


def _unfreed(spec: InteractionDesignSpec, gains: Numbers) -> Numbers:
    """Return gains with the free ones at the values of the spec, as far as it has any.

    A `CertificateError` if one is farther from that than its factors allow.
    """
    found = {name: dict(law_gains) for name, law_gains in gains.items()}
    for name, free in spec.design.free.items():
        for gain, factors in free.given():
            given = _spec_gain(spec, name, gain)
            if given is None:
                continue
            _check_near(name, gain, given, factors, found[name].get(gain, given))
            found[name][gain] = given
    loop = spec.motion_loop
    zero = None if loop is None or loop.derivative_gain is not None else loop.zero
    if MOTION in spec.design.free and zero is not None:
        # The root locus gives Kd, and the zero gives Kp by it: the spec gives neither.
        found[MOTION]["Kp"] = round_float32(found[MOTION]["Kd"] * zero.exact)
    return found


def _spec_gain(spec: InteractionDesignSpec, name: str, gain: str) -> Fraction | None:
    """Return the gain of a controller, or of the motion loop, that the spec gives, if it does."""
    if name == MOTION:
        loop = spec.motion_loop
        if loop is None or loop.derivative_gain is None:
            return None
        Kd = round_float32(loop.derivative_gain.exact)
        if gain == "Kd":
            return Kd
        return None if loop.zero is None else round_float32(Kd * loop.zero.exact)
    given = spec.controllers[name]
    value = getattr(given, LAWS[given.type].fixed.get(gain, gain))
    value = value.min if isinstance(value, GainSpec) else value
    return None if value is None else round_float32(exact_number(value))


def _motion(spec: InteractionDesignSpec, gains: Numbers) -> ProportionalDerivative:
    """Return the motion controller; none where the robot has its own."""
    loop = spec.motion_loop
    if loop is None:
        return NO_MOTION
    motion = ProportionalDerivative.create(gains[MOTION])
    if motion.Kp <= 0 or motion.Kd <= 0:
        raise CertificateError("the gains of the motion controller are not positive")
    given, zero = loop.derivative_gain, loop.zero
    fixed = given is None or motion.Kd == round_float32(given.exact)
    if not fixed or (zero is not None and motion.Kp != round_float32(motion.Kd * zero.exact)):
        raise CertificateError("the gains of the motion controller are not what the spec fixes")
    return motion


def idle_decay(idle: IdleStatesSpec) -> Fraction:
    """Return the rate in 1/s that the robot holds: a single-precision number, as gains are."""
    return round_float32(idle.decay.exact)


def idle_share(idle: IdleStatesSpec, period: Fraction) -> Fraction:
    """Return the share of idle states after a period in s: a single-precision number."""
    return round_float32(exponential_between(-idle_decay(idle) * period)[0])


def _controller(name: str, spec: ControllerSpec, values: Mapping[str, Fraction]) -> Controller:
    for gain, bounds in spec.gains().items():
        low, high = round_float32(bounds.min.exact), round_float32(bounds.max.exact)
        if not low <= values[gain] <= high:
            raise CertificateError(f"gain {gain} of controller {name} is outside its bounds")
    law = LAWS[spec.type].create(values)
    if fault := law.find_fault(spec):
        raise CertificateError(f"controller {name}: {fault}")
    return Controller(name, law, spec.environment, contact_names(spec.contacts))


def _numbers(
    spec: InteractionDesignSpec, name: str, texts: Mapping[str, str]
) -> dict[str, Fraction]:
    """Read the gains of a controller, or of the motion loop."""
    expected: tuple[str, ...] = () if spec.motion_loop is None else ("Kp", "Kd")
    if name != MOTION:
        expected = LAWS[spec.controllers[name].type].gain_names(spec.controllers[name])
    if set(texts) != set(expected):
        mismatch = f"are not {', '.join(expected)}" if expected else "should be no gains at all"
        raise CertificateError(f"the gains of {name} {mismatch}")
    numbers = {gain: parse_exact(texts[gain]) for gain in expected}
    for gain, number in numbers.items():
        if not is_float32(number):
            raise CertificateError(f"gain {gain} of {name} is not a single-precision number")
    return numbers
