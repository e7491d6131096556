"""What a statement about an interaction design in continuous time takes for granted."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import chain

from nrs_design.controllers.controller_design import ControllerDesign
from nrs_design.controllers.float32 import exact_decimal
from nrs_design.controllers.gains import idle_decay
from nrs_design.controllers.laws import LAWS
from nrs_design.loop.assumption import Assumption, say
from nrs_design.loop.assumptions import (
    REST,
    UNCOUPLED,
    at_once_texts,
    command_texts,
    contact_texts,
    ranges_text,
    rule_texts,
)
from nrs_design.loop.shared_state import SharedState
from nrs_design.models.contact.environment import Environment
from nrs_design.spec import IdleStatesSpec, SwitchingSpec
from nrs_design.spec.controllers import Command

_TAKEN = {
    "reference": "the command of the motion loop just before the switch",
    "measured": "the measured position at the switch",
}
NOT_MODELLED = say("not-sampled.continuous")
NOT_MODELLED_BUT_LIMITS = say("not-sampled-but-limited.continuous")


def assume_loop(
    loop: SharedState, rules: SwitchingSpec, *, losable: bool, free: bool
) -> tuple[Assumption, ...]:
    """Say what holds for an interaction design.

    `losable`: the system says how contact is lost, and a statement whether it is kept; `free`: free
    motion is one of the modes.
    """
    loops = ("nominal-motor.given",) if loop.given else ("nominal-motor.designed",)
    return (
        *(map(say, loops) if loop.joint is None else loop.joint.texts(loop.design.axis)),
        *_input_texts(loop, losable=losable),
        UNCOUPLED,
        *_contact_texts(loop),
        *chain.from_iterable(
            tissue_texts(e, alone=len(loop.environments) == 1) for e in loop.environments
        ),
        *(_idle_texts(loop, loop.idle) if loop.idle is not None else ()),
        *_kept_texts(loop, losable=losable, free=free),
        *_switch_texts(loop, rules),
        NOT_MODELLED,
        say("numbers.gains"),
        *command_texts(loop.design.command, loop.design.axis),
    )


def _input_texts(loop: SharedState, *, losable: bool) -> Iterator[Assumption]:
    """Say what acts from outside, and what then rests."""
    if loop.offset != "none":
        yield say("rest-position.moving")
        yield say("at-a-switch.offset", taken=_TAKEN[loop.offset])
        if loop.offset == "measured":
            yield from map(say, ("at-a-switch.lead", "at-a-switch.kick"))
        yield say("inputs.constant")
        return
    yield say("inputs.continuous", rest=REST[losable])
    sprung = any(c.law.spring for c in loop.design.controllers)
    yield say(
        "inputs.bounded",
        "bounded commands; of what size is not said",
        integral=", if the integral of the velocity command is bounded too," if sprung else "",
        # In free motion, a command moves the axis ever further from the surface.
        air=", but not how far the axis moves away while contact is lost" if losable else "",
    )
    if sprung:
        yield say("spring.shared" if loop.idle is None else "spring.idle")


def _contact_texts(loop: SharedState) -> Iterator[Assumption]:
    yield from contact_texts(loop.design)
    if loop.feels and not all(c.contacts for c in loop.design.controllers):
        yield say("contacts.in-position", "what other controllers touch")
    yield from at_once_texts(loop.environments)
    which = "tissue.linear" if loop.offset == "none" else "tissue.offset"
    yield say(which, ranges_text(loop.environments, loop.design.axis))
    integrated = any(c.law.commands == "velocity" for c in loop.design.controllers)
    if integrated and all(e.law.has_rest for e in loop.environments):
        yield say("at-a-switch.deflection")


def tissue_texts(environment: Environment, *, alone: bool) -> Iterator[Assumption]:
    """Say what is taken for granted about an environment that remembers, or has a mass."""
    which = "tissue.law" if environment.law.has_mass else "memory.law"
    for text in environment.law.memory_texts(environment.name, alone=alone):
        yield say(which, text=text)


def _idle_texts(loop: SharedState, idle: IdleStatesSpec) -> Iterator[Assumption]:
    """Say what is taken for granted about the states of controllers that command a velocity."""
    driving = " and ".join(_names(loop.design, "velocity"))
    others = " or ".join(_names(loop.design, "position"))
    decay = idle_decay(idle)
    if driving:
        meanwhile = f"decay at {exact_decimal(decay)} 1/s" if decay else "are held"
        yield say(
            "idle.decay",
            f"while another is active, they {meanwhile}",
            driving=driving.capitalize(),
            driven=driving,
            others=others,
            what=" and ".join((*loop.law.state_words, "the position reference")),
            meanwhile=meanwhile,
        )
    yield from _bleeding_texts(loop.design, decay)
    if idle.reset:
        rest = "".join(f", with {state.split()[0]} = 0" for state in loop.law.states)
        yield say("at-a-switch.zeroed", driving=driving, others=others, rest=rest)
    yield from map(say, ("rest-position.commanded", "at-a-switch.kick"))


def _bleeding_texts(design: ControllerDesign, decay: Fraction) -> Iterator[Assumption]:
    """Say what becomes of an integral while other controllers are active."""
    law = next((c.law for c in design.controllers if c.law.bleeds), None)
    if law is not None:
        others = dict.fromkeys(c.law.name for c in design.controllers if not c.law.bleeds)
        meanwhile = f"decays at {exact_decimal(decay)} 1/s" if decay else "is held"
        yield say(
            "idle.integral",
            f"while another is active, it {meanwhile}",
            others=" or ".join(others),
            states=" and ".join(law.state_words),
            law=law.name,
            meanwhile=meanwhile,
        )


def _names(design: ControllerDesign, command: Command) -> dict[str, None]:
    """Return the names of the laws that give the motion loop such a command, each once."""
    laws = (controller.law for controller in design.controllers)
    return dict.fromkeys(law.name for law in laws if law.commands == command)


def _kept_texts(loop: SharedState, *, losable: bool, free: bool) -> Iterator[Assumption]:
    """Say for which contact it holds; where it may be lost, a statement says that itself."""
    if free:
        yield say("contact-lost.anywhere")
    elif not losable:
        yield from kept_by_laws(loop.design, alone=loop.idle is None)


def kept_by_laws(design: ControllerDesign, *, alone: bool) -> Iterator[Assumption]:
    """Say what each law of a design takes for granted about contact."""
    used = {controller.law.name for controller in design.controllers}
    texts = (law.contact_text(alone=alone) for name, law in LAWS.items() if name in used)
    return (say("contact-kept.law", text=text) for text in texts if text is not None)


def _switch_texts(loop: SharedState, rules: SwitchingSpec) -> Iterator[Assumption]:
    reset = (loop.idle is not None and loop.idle.reset) or loop.offset == "measured"
    states = "All other states are" if reset else "States are"
    if rules.is_arbitrary:
        yield say("at-a-switch.any-signal", states=states)
        return
    yield say("at-a-switch.continuous", states=states)
    yield from rule_texts(rules, "mode" if rules.names_contacts else "controller")
    if not rules.names_contacts and rules.dwell_time is None:
        yield say("any-signal.environment")
