"""Assumptions about an interaction design in continuous time."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from nrs_design.controllers.controller_design import ControllerDesign
from nrs_design.controllers.float32 import exact_decimal
from nrs_design.controllers.gains import idle_decay
from nrs_design.loop.assumptions import (
    UNCOUPLED,
    assume,
    assume_command_unit,
    assume_contacts,
    assume_kept_contact,
    assume_parts,
    assume_rules,
    assume_tissue,
)
from nrs_design.loop.shared_state import REFERENCE, SharedState
from nrs_design.proof.assumption import Assumption
from nrs_design.proof.text import exact_text
from nrs_design.spec import IdleStatesSpec, SwitchingSpec
from nrs_design.spec.controllers import Command


def assume_loop(
    loop: SharedState, rules: SwitchingSpec, *, losable: bool, free: bool, limited: bool
) -> Iterator[Assumption]:
    """Yield the assumptions about an interaction design.

    `losable`: the system says how contact is lost, and a statement whether it is kept; `free`: free
    motion is one of the modes; `limited`: some statement is about signals that saturate.
    """
    yield from _assume_motion(loop)
    yield from _assume_inputs(loop, losable=losable)
    yield UNCOUPLED
    yield from _assume_contact(loop)
    for e in loop.environments:
        yield from e.law.assumptions(e.name, alone=len(loop.environments) == 1)
    yield from () if loop.idle is None else _assume_idle(loop, loop.idle)
    # If contact may be lost, each statement says whether it covers the loss.
    if free:
        yield assume("contact-lost.anywhere")
    elif not losable:
        yield from assume_kept_contact(loop.design, alone=loop.idle is None)
    yield from _assume_switches(loop, rules)
    yield assume(f"not-sampled{'-but-limited' if limited else ''}.continuous")
    yield assume("numbers.gains")
    yield from assume_command_unit(loop.design.command, loop.design.axis)


def _assume_motion(loop: SharedState) -> Iterator[Assumption]:
    """Yield the model of the motion loop and of its load."""
    joint, axis = loop.joint, loop.design.axis
    if joint is None:
        yield assume(f"nominal-motor.{'given' if loop.given else 'designed'}")
        return
    motor = "nominal-motor.joint" if joint.ranges.fixed else "motor.joint"
    yield assume(motor, **joint.ranges.assumed(axis))
    if joint.load_inertia is None:
        yield assume("unloaded.continuous")
    else:
        inertia = f"{exact_text(joint.load_inertia)} {axis.unit('kg*m^2')}"
        yield assume("load.inertia", inertia=inertia)


def _assume_inputs(loop: SharedState, *, losable: bool) -> Iterator[Assumption]:
    """Yield the inputs, and the equilibria for zero inputs."""
    if loop.offset != "none":
        yield assume("rest-position.moving")
        yield assume("at-a-switch.offset", taken=loop.offset)
        if loop.offset == "measured":
            yield assume("at-a-switch.lead")
            yield assume("at-a-switch.kick")
        yield assume("inputs.constant")
        return
    yield assume("inputs.continuous", rest="contact" if losable else "always")
    sprung = any(c.law.spring for c in loop.design.controllers)
    yield assume("inputs.bounded", also=sprung and "bounded", air=losable and "open")
    if sprung:
        yield assume("spring.shared" if loop.idle is None else "spring.idle")


def _assume_contact(loop: SharedState) -> Iterator[Assumption]:
    yield from assume_contacts(loop.design)
    if loop.feels and not all(c.contacts for c in loop.design.controllers):
        yield assume("contacts.in-position")
    yield from assume_parts(loop.environments)
    which = "tissue.linear" if loop.offset == "none" else "tissue.offset"
    yield from assume_tissue(loop.environments, loop.design.axis, which)
    integrated = any(c.law.commands == "velocity" for c in loop.design.controllers)
    if integrated and all(e.law.has_rest for e in loop.environments):
        yield assume("at-a-switch.deflection")


def _assume_idle(loop: SharedState, idle: IdleStatesSpec) -> Iterator[Assumption]:
    """Yield the evolution of idle states of impedance controllers."""
    axis = loop.design.axis
    driving, others = (_names(loop.design, command) for command in ("velocity", "position"))
    decay = idle_decay(idle)
    if driving:
        yield assume(
            "idle.decay" if decay else "idle.held",
            driving=driving,
            others=others,
            states=tuple(map(axis.named, (*loop.law.states, REFERENCE))),
            decay=decay and exact_decimal(decay),
        )
    yield from _assume_bleeding(loop.design, decay)
    if idle.reset and driving:
        yield assume("at-a-switch.zeroed", driving=driving, others=others)
    yield assume("rest-position.commanded")
    yield assume("at-a-switch.kick")


def _assume_bleeding(design: ControllerDesign, decay: Fraction) -> Iterator[Assumption]:
    """Yield the evolution of an idle integral."""
    law = next((c.law for c in design.controllers if c.law.bleeds), None)
    if law is not None:
        others = dict.fromkeys(c.law.name for c in design.controllers if not c.law.bleeds)
        yield assume(
            "idle.integral" if decay else "idle.held-integral",
            others=tuple(others),
            states=tuple(map(design.axis.named, law.states)),
            law=law.name,
            decay=decay and exact_decimal(decay),
        )


def _names(design: ControllerDesign, command: Command) -> tuple[str, ...]:
    """Return the distinct names of the laws with this type of command."""
    laws = (controller.law for controller in design.controllers)
    return tuple(dict.fromkeys(law.name for law in laws if law.commands == command))


def _assume_switches(loop: SharedState, rules: SwitchingSpec) -> Iterator[Assumption]:
    reset = (loop.idle is not None and loop.idle.reset) or loop.offset == "measured"
    states = "others" if reset else "all"
    if rules.is_arbitrary:
        yield assume("at-a-switch.any-signal", which=states)
        return
    yield assume("at-a-switch.continuous", which=states)
    yield from assume_rules(rules, "mode" if rules.names_contacts else "controller")
    if not rules.names_contacts and rules.dwell_time is None:
        yield assume("any-signal.environment")
