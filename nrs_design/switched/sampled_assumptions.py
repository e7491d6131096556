"""What a statement about the sampled loop takes for granted, in words."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Literal

from nrs_design.controllers.controller_design import ControllerDesign
from nrs_design.controllers.float32 import exact_decimal
from nrs_design.controllers.sampled import SampledAdmittance, SampledMotion
from nrs_design.models.actuator import ActuatorRanges
from nrs_design.proof.bounds import rounded_down
from nrs_design.proof.text import exact_text
from nrs_design.spec import InteractionDesignSpec
from nrs_design.spec.sampling import SamplingSpec
from nrs_design.switched.assumptions import (
    CONTINUOUS,
    LOST_ANYWHERE,
    LOST_CONTACT,
    REST,
    SPRING,
    UNCOUPLED,
    rule_texts,
)
from nrs_design.switched.joint import motor_text

_INPUTS = "All inputs are zero (velocity command, motion of the environment); "
_NOT_MODELLED = (
    "The quantization of encoder and force sensor, friction and saturation are not modelled."
)
_AT_SAMPLE = "At a sample the spring takes the q of before the reference moves on."
_ARITHMETIC = (
    "The arithmetic is that of single precision, rounded to nearest, without overflow and "
    "underflow; no term of the law is rounded more often than this: {}."
)
_ANGLES = (
    "That joint angle and reference are single-precision numbers of limited resolution is left out."
)
_HELD = (
    "Joint angle and reference stay within {}, and are rounded like every other number; that "
    "acts where a statement names it."
)
# What is said of a sensor stands in lines of its own.
_SENSED = "The quantization of the encoder, friction and saturation are not modelled."
_DISTURBED = (
    "A disturbance acts where a statement names it, and keeps its value from one sample to the "
    "next; that friction changes its sign within a period is not covered.",
    "A bound on the force holds at the samples; what happens in between is not claimed.",
)
# Where contact is lost: only where the spring of the tissue ends, or whatever the deflection.
Loss = Literal["never", "not modelled", "anywhere", "on the surface"]
_LOST: Mapping[Loss, str] = MappingProxyType(
    {
        "never": "Contact is not lost: free motion is not one of the modes.",
        "not modelled": "Contact is not lost: that an environment with damping lags behind is not "
        "modelled in the sampled loop.",
        "anywhere": LOST_ANYWHERE,
        "on the surface": LOST_CONTACT,
    }
)


def assume_sampled(
    spec: InteractionDesignSpec,
    sampling: SamplingSpec,
    ranges: ActuatorRanges,
    motion: SampledMotion,
    laws: Mapping[str, SampledAdmittance],
    design: ControllerDesign,
    loss: Loss,
    counts: Mapping[str, int],
) -> tuple[str, ...]:
    """Say what holds for the sampled loop of an interaction design.

    Parameters
    ----------
    spec : InteractionDesignSpec
        With the rules of switching.
    sampling : SamplingSpec
        Its processor.
    ranges : ActuatorRanges
        Where the actuator may be.
    motion : SampledMotion
        With its coefficients.
    laws : mapping
        The admittances by the names of their controllers.
    design : ControllerDesign
        With the contacts.
    loss : {"never", "not modelled", "anywhere", "on the surface"}
        Where contact is lost.
    counts : mapping of str to int
        How often each term of the law is rounded.
    """
    rules = spec.switching
    switched = f"States are {CONTINUOUS}; a switch happens at a sample."
    return (
        f"The law runs every {exact_text(sampling.period.exact)} s, without jitter; its command is "
        "held in between.",
        _delay_text(*sampling.delay),
        f"The motor follows the linear actuator model of the spec; {_actuator_text(ranges)}.",
        "The tissue does not load the motor: it acts through the force sensor alone.",
        *(_DISTURBED if spec.disturbances is not None else ()),
        _beside(spec, _INPUTS + REST[loss == "on the surface"]),
        *((SPRING, _AT_SAMPLE) if any(law.Kt for law in laws.values()) else ()),
        UNCOUPLED,
        *(
            f"While {c.name} is active, nothing but {' or '.join(c.contacts)} is touched."
            for c in design.controllers
        ),
        "In contact, the environment follows its linear model; its parameters stay in the declared "
        "ranges and may change arbitrarily fast.",
        _LOST[loss],
        switched,
        *rule_texts(rules, "controller"),
        f"The coefficients are these single-precision numbers: {_coefficients(motion, laws)}.",
        _ARITHMETIC.format(", ".join(f"{name} {count}" for name, count in counts.items())),
        _angle_text(spec),
        _beside(spec, _NOT_MODELLED if spec.sensor is None else _SENSED),
    )


def _angle_text(spec: InteractionDesignSpec) -> str:
    if spec.disturbances is None or spec.disturbances.largest_angle is None:
        return _ANGLES
    return _HELD.format(rounded_down(spec.disturbances.largest_angle.not_below, "rad"))


def _beside(spec: InteractionDesignSpec, text: str) -> str:
    """Begin a sentence that does not hold for the disturbances of the spec."""
    if spec.disturbances is None:
        return text
    return f"Otherwise, {text[0].lower()}{text[1:]}"


def _delay_text(least: int, most: int) -> str:
    if least == most == 0:
        return "The law uses the force sample of the moment."
    if least == most:
        return f"The law uses a force sample that is {_samples(most)} old."
    return (
        f"The law uses a force sample that is {least} to {_samples(most)} old, any of these at "
        "every sample."
    )


def _samples(count: int) -> str:
    return f"{count} sample{'s' * (count != 1)}"


def _actuator_text(ranges: ActuatorRanges) -> str:
    return motor_text(ranges) + ("" if ranges.fixed else ", and may change at every sample")


def _coefficients(motion: SampledMotion, laws: Mapping[str, SampledAdmittance]) -> str:
    texts = [f"Kp = {exact_decimal(motion.Kp)}", f"Kd/T = {exact_decimal(motion.D)}"]
    for name, law in laws.items():
        texts += [f"{key} of {name} = {exact_decimal(c)}" for key, c in law.coefficients.items()]
    return ", ".join(texts)
