"""What a statement about the sampled loop takes for granted, in words."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import Literal

from nrs_design.controllers.controller_design import ControllerDesign
from nrs_design.controllers.float32 import exact_decimal
from nrs_design.controllers.laws import LAWS
from nrs_design.models.actuator import ActuatorRanges
from nrs_design.models.contact.environment import Environment
from nrs_design.proof.bounds import rounded_down
from nrs_design.proof.text import exact_text
from nrs_design.spec import InteractionDesignSpec
from nrs_design.spec.sampling import SamplingSpec
from nrs_design.switched import assumption_kinds as kinds
from nrs_design.switched.assumption import Assumption
from nrs_design.switched.assumptions import (
    CONTINUOUS,
    LOST_ANYWHERE,
    REST,
    SPRING,
    SPRING_BESIDE,
    UNCOUPLED,
    command_texts,
    contact_texts,
    ranges_text,
    rule_texts,
)
from nrs_design.switched.joint import motor_text
from nrs_design.switched.sampled_frame import Frame
from nrs_design.switched.sampled_gains import SampledGains
from nrs_design.switched.sampled_motor import EXPONENTIAL_BITS

_INPUTS = "All inputs are zero (velocity command, motion of the environment); "
_PLACED_INPUTS = (
    "All inputs are zero (commands, wanted force, motion of the environment), and the commanded "
    "position is that at which the contact carries no force; "
)
_PLACED = kinds.REST_POSITION.says(
    "Position and force controllers set the reference before the error is formed, to the commanded "
    "position; a force controller adds Kp times the difference of the wanted force and its sample. "
    "At a switch the reference may jump, and the error of the sample before is kept: the PD "
    "differentiates the jump."
)
_IN_POSITION = kinds.CONTACTS.says(
    "In position control any of the environments may be touched, or nothing: the force is sampled, "
    "and used no earlier than by the next controller that takes it.",
    "the environments of the spec",
)
_RETUNED = kinds.AT_A_SWITCH.says(
    "The coefficients of retuned gains are those of the formulas, each rounded once; where gains "
    "change, the admittance keeps its states."
)
_NOT_MODELLED = (
    "The quantization of encoder and force sensor, friction and saturation are not modelled."
)
_AT_SAMPLE = kinds.SPRING.says(
    "At a sample the spring takes the q of before the reference moves on."
)
_ARITHMETIC = (
    "The arithmetic is that of single precision, rounded to nearest, without overflow and "
    "underflow; no term of the law is rounded more often than this: {}."
)
_ANGLES = kinds.ARITHMETIC.says(
    "That joint angle and reference are single-precision numbers of limited resolution is left out."
)
_HELD = (
    "Joint angle and reference stay within {}, and are rounded like every other number; that "
    "acts where a statement names it."
)
# What is said of a sensor stands in lines of its own.
_SENSED = "The quantization of the encoder, friction and saturation are not modelled."
_DISTURBED = (
    kinds.FRICTION.says(
        "A disturbance acts where a statement names it, and keeps its value from one sample to the "
        "next; that friction changes its sign within a period is not covered."
    ),
    kinds.AT_SAMPLES.says(
        "A bound on the force holds at the samples; what happens in between is not claimed."
    ),
)
# Where contact is lost: only where the spring of the tissue ends, or whatever the deflection.
Loss = Literal[
    "never",
    "not modelled",
    "not under force control",
    "anywhere",
    "anywhere under force control",
    "on the surface",
]
_LOST: Mapping[str, Assumption] = MappingProxyType(
    {
        "never": kinds.CONTACT_KEPT.says(
            "Contact is not lost: free motion is not one of the modes."
        ),
        "not modelled": kinds.CONTACT_KEPT.says(
            "Contact is not lost: that is not modelled for what is known within a preload, or has "
            "damping and is touched at once with others."
        ),
        "anywhere": LOST_ANYWHERE,
        "anywhere under force control": kinds.CONTACT_LOST.says(
            "Contact may be lost and made again at any moment, whatever the deflection: free "
            "motion under force control, whose sample is zero then, is one of the modes. The "
            "surface is back in its place at once."
        ),
    }
)


def assume_sampled(
    spec: InteractionDesignSpec,
    sampling: SamplingSpec,
    ranges: ActuatorRanges,
    frame: Frame,
    gains: Mapping[str, SampledGains],
    design: ControllerDesign,
    loss: Loss,
    touched: Sequence[Environment],
) -> tuple[Assumption, ...]:
    """Say what holds for the sampled loop of an interaction design.

    Parameters
    ----------
    spec : InteractionDesignSpec
        With the rules of switching.
    sampling : SamplingSpec
        Its processor.
    ranges : ActuatorRanges
        Where the actuator may be.
    frame : Frame
        Of all modes.
    gains : mapping
        The laws by the names of their controllers.
    design : ControllerDesign
        With the contacts.
    loss : str
        Where contact is lost.
    touched : sequence of Environment
        All contacts.
    """
    rules = spec.switching
    reset = spec.idle_states is not None and spec.idle_states.reset
    states = "All other states are" if reset else "States are"
    inputs = _PLACED_INPUTS if "under force control" in loss else _INPUTS
    return (
        *_period_texts(sampling, design),
        _delay_text(*sampling.delay),
        (kinds.NOMINAL_MOTOR if ranges.fixed else kinds.MOTOR).says(
            f"The motor follows the linear actuator model of the spec; {_actuator_text(ranges)}.",
            motor_text(ranges),
        ),
        kinds.UNLOADED.says(
            "The tissue does not load the motor: it acts through the force sensor alone."
        ),
        *(_DISTURBED if spec.disturbances is not None else ()),
        kinds.INPUTS.says(_beside(spec, inputs + REST[loss == "on the surface"])),
        *_spring_texts(frame, design),
        *_placed_texts(frame, design, reset=reset),
        UNCOUPLED,
        *contact_texts(design),
        kinds.TISSUE.says(
            "In contact, the environment follows its linear model; its parameters stay in the "
            "declared ranges and may change arbitrarily fast.",
            ranges_text(touched),
        ),
        *_loss_texts(loss, design, frame),
        kinds.AT_A_SWITCH.says(f"{states} {CONTINUOUS}; a switch happens at a sample."),
        *rule_texts(rules, "controller"),
        kinds.NUMBERS.says(
            f"The coefficients are these single-precision numbers: {_coefficients(frame, gains)}."
        ),
        *command_texts(design.command),
        *_retuned_texts(gains),
        kinds.ARITHMETIC.says(
            _ARITHMETIC.format(", ".join(f"{name} {n}" for name, n in frame.counts.items()))
        ),
        _angle_text(spec),
        kinds.NOT_QUANTIZED.says(_beside(spec, _NOT_MODELLED if spec.sensor is None else _SENSED)),
    )


def _period_texts(sampling: SamplingSpec, design: ControllerDesign) -> Iterator[Assumption]:
    """Say when what is computed."""
    if sampling.round == 1:
        yield kinds.PERIOD.says(
            f"The law runs every {exact_text(sampling.period.exact)} s, without jitter; its "
            "command is held in between.",
            f"{exact_text(sampling.period.exact)} s, exactly",
        )
        return
    filtered = "" if design.sensor.filter is None else ", the filter of the force"
    yield kinds.PERIOD.says(
        f"The motion loop runs every {exact_text(sampling.period.exact)} s; its command is held in "
        f"between. The force is sampled{filtered} and the admittance runs every "
        f"{exact_text(sampling.outer)} s; its reference is held in between. Neither has jitter, "
        "and every sample of the slower loop is one of the faster.",
        f"{exact_text(sampling.period.exact)} s and {exact_text(sampling.outer)} s, exactly",
    )
    yield kinds.PERIOD.says(
        "Where both are due, the motion loop comes first: it takes the reference of before. What "
        "the admittance makes of a sample is used from the next sample on. The age of a force "
        "sample is counted in samples of the admittance.",
        "the order that is named",
    )


def _spring_texts(frame: Frame, design: ControllerDesign) -> tuple[Assumption, ...]:
    if not any(c.law.spring for c in design.controllers):
        return ()
    return SPRING if frame.idle is None else SPRING_BESIDE, _AT_SAMPLE


def _placed_texts(frame: Frame, design: ControllerDesign, *, reset: bool) -> Iterator[Assumption]:
    """Say what position and force controllers do, and what the others do meanwhile."""
    if all(c.law.commands == "velocity" for c in design.controllers):
        return
    yield _PLACED
    if not all(c.contacts for c in design.controllers):
        yield _IN_POSITION
    if any(c.law.bleeds for c in design.controllers):
        yield from _integral_texts(frame, design)
    moving = [c.law for c in design.controllers if c.law.commands == "velocity"]
    if frame.idle is None or not moving:
        return
    what = "velocity vm and reference" if any(law.states for law in moving) else "the reference"
    yield kinds.IDLE.says(
        f"While a position or force controller is active, {what} of the impedance controllers act "
        f"on nothing, and a sample leaves d = {exact_decimal(frame.idle)} of them."
    )
    if reset:
        yield kinds.AT_A_SWITCH.says(
            "When an impedance controller is left for one of these, they are set to zero first."
        )


def _integral_texts(frame: Frame, design: ControllerDesign) -> Iterator[Assumption]:
    """Say what becomes of the integral of a PI force controller."""
    yield kinds.IDLE.says(
        "A pi-force controller adds the integral w of its force error besides, and a sample adds "
        "Ki_T times the difference of the wanted force and its sample to w."
    )
    others = dict.fromkeys(c.law.name for c in design.controllers if not c.law.bleeds)
    if others and frame.idle is not None:
        yield kinds.IDLE.says(
            f"While a {' or '.join(others)} controller is active, w stays in the reference, and a "
            f"sample leaves g = {exact_decimal(frame.idle)} of it. No switch changes w."
        )


def _loss_texts(loss: Loss, design: ControllerDesign, frame: Frame) -> Iterator[Assumption]:
    if loss == "on the surface":
        # How, is said where a statement covers it.
        return
    if loss != "not under force control":
        yield _LOST[loss]
        return
    used = {c.law.name for c in design.controllers}
    texts = (law.contact_text(alone=frame.idle is None) for n, law in LAWS.items() if n in used)
    yield from (kinds.CONTACT_KEPT.says(text) for text in texts if text is not None)


def _retuned_texts(gains: Mapping[str, SampledGains]) -> Iterator[Assumption]:
    ranged = {name: item for name, item in gains.items() if item.box.ranges}
    for name, item in ranged.items():
        yield from item.texts(name)
    if ranged:
        yield _RETUNED


def _angle_text(spec: InteractionDesignSpec) -> Assumption:
    if spec.disturbances is None or spec.disturbances.largest_angle is None:
        return _ANGLES
    largest = rounded_down(spec.disturbances.largest_angle.not_below, "rad")
    return kinds.ARITHMETIC.says(_HELD.format(largest), f"angles within {largest}")


def _beside(spec: InteractionDesignSpec, text: str) -> str:
    """Begin a sentence that does not hold for the disturbances of the spec."""
    if spec.disturbances is None:
        return text
    return f"Otherwise, {text[0].lower()}{text[1:]}"


def _delay_text(least: int, most: int) -> Assumption:
    age = kinds.SAMPLE_AGE
    if least == most == 0:
        return age.says("The law uses the force sample of the moment.", "0 samples")
    if least == most:
        return age.says(
            f"The law uses a force sample that is {_samples(most)} old.", _samples(most)
        )
    return age.says(
        f"The law uses a force sample that is {least} to {_samples(most)} old, any of these at "
        "every sample.",
        f"{least} to {_samples(most)}",
    )


def _samples(count: int) -> str:
    return f"{count} sample{'s' * (count != 1)}"


def _actuator_text(ranges: ActuatorRanges) -> str:
    tau = ranges.time_constant
    return (
        motor_text(ranges)
        + ("" if ranges.fixed else ", and may change at every sample, not in between")
        + ". A proof covers exp(-T/tau) in what encloses it; what refutes may be at "
        + (
            f"an end, less than 2^-{EXPONENTIAL_BITS - 1} away"
            if tau.low == tau.high
            else "a corner of that, of no motor of the range"
        )
    )


def _coefficients(frame: Frame, gains: Mapping[str, SampledGains]) -> str:
    texts = [f"Kp = {exact_decimal(frame.step.Kp)}", f"Kd/T = {exact_decimal(frame.step.D)}"]
    for name, item in gains.items():
        coefficients = item.law.coefficients.items()
        texts += [f"{key} of {name} = {exact_decimal(c)}" for key, c in coefficients]
    return ", ".join(texts)
