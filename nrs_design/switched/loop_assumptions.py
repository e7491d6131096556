"""What a statement about an interaction design takes for granted, in words."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from itertools import chain

from nrs_design.controllers.controller_design import ControllerDesign
from nrs_design.controllers.float32 import exact_decimal
from nrs_design.controllers.gains import idle_decay
from nrs_design.controllers.laws import LAWS, CompliantLaw
from nrs_design.models.contact.environment import Environment
from nrs_design.spec import IdleStatesSpec, SwitchingSpec
from nrs_design.spec.controllers import Command, Offset
from nrs_design.switched import assumption_kinds as kinds
from nrs_design.switched.assumption import Assumption
from nrs_design.switched.assumptions import (
    CONTINUOUS,
    LOST_ANYWHERE,
    REST,
    SPRING,
    SPRING_BESIDE,
    UNCOUPLED,
    at_once_texts,
    command_texts,
    contact_texts,
    ranges_text,
    rule_texts,
)
from nrs_design.switched.gain_box import GainBox
from nrs_design.switched.joint import Joint

_GIVEN_LOOP = kinds.NOMINAL_MOTOR.says(
    "The motion loop is the transfer function G(s) that the spec states, whatever the motion gains "
    "listed here.",
    "the G(s) of the spec",
)
_DESIGNED_LOOP = kinds.NOMINAL_MOTOR.says(
    "The motion loop is the linear actuator model of the spec, at its nominal values and not "
    "loaded by what is touched, under the motion gains listed here."
)
_INPUTS = "All inputs are zero (velocity command, reference force, motion of the environment); "
# In free motion, a command moves the axis ever further from the surface.
_COMMANDED = (
    "Under a constant command the modes may rest at different points. Where stability is proved, "
    "bounded inputs{} keep the state bounded{}; how far it goes, and that it settles, is not "
    "claimed."
)
_IN_THE_AIR = ", but not how far the axis moves away while contact is lost"
_CONTACT = (
    "In contact, the environment follows its linear model; its parameters stay in the declared "
    "ranges and may change arbitrarily fast."
)
_AT_A_SWITCH = {
    "deflection": kinds.AT_A_SWITCH.says(
        "The deflection is continuous at a switch; the force may jump."
    ),
    "force": kinds.AT_A_SWITCH.says(
        "Wherever stiffness or damping changes, at a switch or within its range, the force stays "
        "and the deflection jumps (the thesis's coordinates; not physical in lasting contact)."
    ),
}
_KICK = kinds.AT_A_SWITCH.says(
    "The reference that the motion loop follows, and with it the velocity, may jump at a "
    "switch; position and motion state xi do not: the PD differentiates the jump. A controller "
    "that leaves this kick out is not covered."
)
# What holds with an offset, where a mode rests wherever the offset lets it.
_MOVING = kinds.REST_POSITION.says(
    "The state is the motion of the loop: the rates dxp of its states, and the lead of its command "
    "before the position. That it decays says that the axis comes to rest, not where: the offset "
    "X_i holds it there, and the force that is left depends on X_i."
)
_CONSTANT = kinds.INPUTS.says(
    "All inputs are zero: position command, reference force Fd and environment do not move, and at "
    "a switch to force control the force is Fd. What it is off there, times Kp, is a jump of the "
    "command; such jumps, and a moving command, are inputs that nothing is claimed about."
)
_TAKEN = {
    "reference": "the command of the motion loop just before the switch",
    "measured": "the measured position at the switch",
}
_SAME_STIFFNESS = (
    "In contact, the environment follows its linear model, with parameters in the declared ranges. "
    "Where a stiffness changes while force is controlled, the step of the force that comes with it "
    "is an input, too; what it does to the motion is covered, arbitrarily fast."
)
NOT_MODELLED = kinds.NOT_SAMPLED.says(
    "Continuous time: sampling, delay, quantization, friction and saturation are not modelled."
)
NOT_MODELLED_BUT_LIMITS = kinds.NOT_SAMPLED_BUT_LIMITED.says(
    "Continuous time: sampling, delay, quantization and friction are not modelled, saturation only "
    "where a statement says so."
)


@dataclass(frozen=True, slots=True)
class Assumed:
    """The closed loop, as far as its assumptions depend on it."""

    design: ControllerDesign  # All controllers
    touched: tuple[Environment, ...]  # What they touch
    boxes: Mapping[str, GainBox]  # Where the gains of each controller may be
    coordinates: str  # Of an impedance mode
    rules: SwitchingSpec  # For the change of controllers
    idle: IdleStatesSpec | None  # What idle states do, where there are any
    law: CompliantLaw  # A law that has the states that all modes share
    given: bool  # Whether the spec states the motion loop itself
    # Whether the system says how contact is lost; then a statement says whether it is kept.
    losable: bool = False
    offset: Offset = "none"  # Where force controllers take their offset from
    free: bool = False  # Whether free motion is one of the modes
    joint: Joint | None = None  # The motor, where it has ranges or is loaded by the environment


def assume_loop(loop: Assumed) -> tuple[Assumption, ...]:
    """Say what holds for an interaction design."""
    return (
        *_loop_texts(loop),
        *_input_texts(loop),
        UNCOUPLED,
        *_contact_texts(loop),
        *chain.from_iterable(_memories(e, alone=len(loop.touched) == 1) for e in loop.touched),
        *(_idle_texts(loop, loop.idle) if loop.idle is not None else ()),
        *_kept_texts(loop),
        *_switch_texts(
            loop.rules,
            reset=(loop.idle is not None and loop.idle.reset) or loop.offset == "measured",
        ),
        NOT_MODELLED,
        *_gain_texts(loop.boxes, loop.design.command),
    )


def _input_texts(loop: Assumed) -> tuple[Assumption, ...]:
    """Say what acts from outside, and what then rests."""
    if loop.offset == "none":
        return kinds.INPUTS.says(_INPUTS + REST[loop.losable]), *_command_texts(loop)
    taken = kinds.AT_A_SWITCH.says(
        f"X_i is taken at every switch of controllers, as {_TAKEN[loop.offset]}, and held until "
        "the next; in position mode the command is X_i and what the operator commands since."
    )
    lead = kinds.AT_A_SWITCH.says("At a switch of controllers the lead is set to zero.")
    measured = (lead, _KICK) if loop.offset == "measured" else ()
    return _MOVING, taken, *measured, _CONSTANT


def _loop_texts(loop: Assumed) -> Iterator[Assumption]:
    if loop.joint is not None:
        return loop.joint.texts()
    return iter((_GIVEN_LOOP if loop.given else _DESIGNED_LOOP,))


def _command_texts(loop: Assumed) -> Iterator[Assumption]:
    sprung = any(c.law.spring for c in loop.design.controllers)
    integral = ", if the integral of the velocity command is bounded too," if sprung else ""
    sentence = _COMMANDED.format(integral, _IN_THE_AIR if loop.losable else "")
    yield kinds.INPUTS.says(sentence, "bounded commands; of what size is not said")
    if sprung:
        yield SPRING if loop.idle is None else SPRING_BESIDE


def _contact_texts(loop: Assumed) -> Iterator[Assumption]:
    yield from contact_texts(loop.design)
    yield from at_once_texts(loop.touched)
    sentence = _CONTACT if loop.offset == "none" else _SAME_STIFFNESS
    yield kinds.TISSUE.says(sentence, ranges_text(loop.touched))
    integrated = any(c.law.commands == "velocity" for c in loop.design.controllers)
    if integrated and all(e.law.has_rest for e in loop.touched):
        yield _AT_A_SWITCH[loop.coordinates]


def _memories(environment: Environment, *, alone: bool) -> Iterator[Assumption]:
    kind = kinds.TISSUE if environment.law.has_mass else kinds.MEMORY
    return map(kind.says, environment.law.memory_texts(environment.name, alone=alone))


def _idle_texts(loop: Assumed, idle: IdleStatesSpec) -> Iterator[Assumption]:
    """Say what is taken for granted about the states of controllers that command a velocity."""
    driving = " and ".join(_names(loop.design, "velocity"))
    others = " or ".join(_names(loop.design, "position"))
    what = " and ".join((*loop.law.state_words, "the position reference"))
    decay = idle_decay(idle)
    meanwhile = f"decay at {exact_decimal(decay)} 1/s" if decay else "are held"
    if driving:
        yield kinds.IDLE.says(
            f"{driving.capitalize()} controllers integrate their velocity to a position reference "
            f"of the motion loop. While a {others} controller is active, {what} of the {driving} "
            f"controllers act on nothing and {meanwhile}.",
            f"while another is active, they {meanwhile}",
        )
    yield from _bleeding_texts(loop.design, decay)
    if idle.reset:
        rest = "".join(f", with {state.split()[0]} = 0" for state in loop.law.states)
        yield kinds.AT_A_SWITCH.says(
            f"At a switch from {driving} controllers to {others} controllers they are set to zero: "
            f"{driving} controllers start from the rest position{rest}."
        )
    yield kinds.REST_POSITION.says(
        "The commanded position is that at which the contact carries no force; position and "
        "reference are counted from it."
    )
    yield _KICK


def _bleeding_texts(design: ControllerDesign, decay: Fraction) -> Iterator[Assumption]:
    """Say what becomes of an integral while other controllers are active."""
    law = next((c.law for c in design.controllers if c.law.bleeds), None)
    if law is None:
        return
    others = " or ".join(dict.fromkeys(c.law.name for c in design.controllers if not c.law.bleeds))
    meanwhile = f"decays at {exact_decimal(decay)} 1/s" if decay else "is held"
    yield kinds.IDLE.says(
        f"While a {others} controller is active, {' and '.join(law.state_words)} of the {law.name} "
        f"controllers {meanwhile}, and stays in the command of the motion loop meanwhile. No "
        "switch changes it; one that is set to zero, or to another value, is not covered.",
        f"while another is active, it {meanwhile}",
    )


def _names(design: ControllerDesign, command: Command) -> dict[str, None]:
    """Return the names of the laws that give the motion loop such a command, each once."""
    laws = (controller.law for controller in design.controllers)
    return dict.fromkeys(law.name for law in laws if law.commands == command)


def _kept_texts(loop: Assumed) -> Iterator[Assumption]:
    if loop.losable:
        # How, is said where a statement covers it.
        return iter(())
    if loop.free:
        return iter((LOST_ANYWHERE,))
    used = {controller.law.name for controller in loop.design.controllers}
    texts = (law.contact_text(alone=loop.idle is None) for law in LAWS.values() if law.name in used)
    return (kinds.CONTACT_KEPT.says(text) for text in texts if text is not None)


def _switch_texts(rules: SwitchingSpec, *, reset: bool) -> tuple[Assumption, ...]:
    states = "All other states are" if reset else "States are"
    if rules.is_arbitrary:
        return (
            kinds.AT_A_SWITCH.says(f"{states} {CONTINUOUS}; any switching signal is possible."),
        )
    jump = kinds.AT_A_SWITCH.says(f"{states} {CONTINUOUS}.")
    environment = kinds.ANY_SIGNAL.says(
        "While a controller is active, the environment that it touches may change among its "
        "contacts at any time."
    )
    if rules.names_contacts:
        return (jump, *rule_texts(rules, "mode"))
    contacts = () if rules.dwell_time is not None else (environment,)
    return (jump, *rule_texts(rules, "controller"), *contacts)


def _gain_texts(boxes: Mapping[str, GainBox], command: str) -> Iterator[Assumption]:
    ranged = {name: box for name, box in boxes.items() if not box.fixed}
    where = ", or anywhere in their ranges" if ranged else ""
    yield kinds.NUMBERS.says(f"The gains are the single-precision numbers listed here{where}.")
    yield from command_texts(command)
    for name, box in ranged.items():
        yield from box.range_texts(name)
    retuned = dict.fromkeys(box.law.retuned_text for box in ranged.values())
    yield from map(kinds.AT_A_SWITCH.says, retuned)
