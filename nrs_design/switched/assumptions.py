"""What a statement about given matrices, or about any switching, takes for granted, in words."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

from nrs_design.proof.text import exact_text
from nrs_design.spec import DwellTime, SwitchedSystemSpec, SwitchingSpec
from nrs_design.spec.interval import Interval
from nrs_design.spec.units import THESIS_COMMAND
from nrs_design.switched import assumption_kinds as kinds
from nrs_design.switched.assumption import Assumption
from nrs_design.switched.parameters import UncertainParameter

if TYPE_CHECKING:
    from nrs_design.controllers.controller_design import ControllerDesign
    from nrs_design.models.contact.environment import Environment
    from nrs_design.spec import InteractionDesignSpec
    from nrs_design.spec.provenance import IdentifiedRangesSpec

MAX_LISTED = 20
LOST_CONTACT = kinds.CONTACT_LOST.says(
    "Contact is lost where the deflection is not positive, or where the environment would have to "
    "pull; its surface is then back in its place at once."
)
# What follows for inputs of zero, by whether contact may be lost: in the air, the deflection may
# stay anywhere.
REST = {
    False: "all modes then rest at one point, the state zero.",
    True: "all modes in contact then rest at one point, the state zero.",
}
# What a bounded velocity command adds up to is not bounded.
SPRING = kinds.SPRING.says(
    "The spring Kt of an admittance acts on q, by how much the admittances have moved the position "
    "reference: the integral of vm over all controllers, which no switch resets. The reference "
    "itself stays where the contact is at rest. At rest elsewhere it is a constant input; while it "
    "moves on, as under a lasting velocity command, the force grows with it."
)
# Where other controllers leave the position reference idle.
SPRING_BESIDE = kinds.SPRING.says(
    "The spring Kt of an admittance acts on the position reference of the impedance controllers, "
    "and draws it to zero; a lasting velocity command moves it on, and the force grows with it."
)
LOST_ANYWHERE = kinds.CONTACT_LOST.says(
    "Contact may be lost and made again at any moment, whatever the deflection: free motion, in "
    "which the spring draws the axis back, is one of the modes. The surface is back in its place "
    "at once."
)
UNCOUPLED = kinds.UNCOUPLED.says("The axes of the robot do not act on each other.")
CONTINUOUS = "continuous at a switch (identity resets)"
_TAKES = "The motor takes commands in "
_STAYS = {
    "dwell_time": "stays active for at least",
    "longest_dwell_time": "is left after at most",
}
_ENDS = {"dwell_time": "at least", "longest_dwell_time": "at most"}
_THEN = {"dwell_time": " before the next switch", "longest_dwell_time": ""}
GIVEN_MATRICES = (
    kinds.MATRICES.says(
        "The modes are the matrices of the spec, taken exactly; the input is zero."
    ),
    kinds.AT_A_SWITCH.says(f"The state is {CONTINUOUS}; any switching signal is possible."),
)


def assume_matrices(
    spec: SwitchedSystemSpec, parameters: Sequence[UncertainParameter], scale: Fraction
) -> tuple[Assumption, ...]:
    """Say what holds for a `switched-system` spec.

    Parameters
    ----------
    spec : SwitchedSystemSpec
        With the rules of switching.
    parameters : sequence of UncertainParameter
        Where they lie, already scaled.
    scale : Fraction
        By how much they are.
    """
    return (
        GIVEN_MATRICES[0],
        *map(_parameter_text, parameters),
        *scale_texts(scale),
        *_switch_texts(spec),
    )


def _switch_texts(spec: SwitchedSystemSpec) -> tuple[Assumption, ...]:
    if spec.switching.is_arbitrary and not spec.resets:
        return GIVEN_MATRICES[1:]
    jump = f"The state is {CONTINUOUS}."
    if spec.resets:
        switches = [(reset.source, reset.target) for reset in spec.resets]
        jump = (
            f"At a switch {_listed(list(dict.fromkeys(switches)))} the state is mapped as the "
            "resets of the spec say; at every other switch it is continuous."
        )
        if len(set(switches)) < len(switches):
            jump += (
                " Where several resets lead from one mode to another, any one of them may happen, "
                "and always one of them does."
            )
    return kinds.AT_A_SWITCH.says(jump), *rule_texts(spec.switching, "mode")


def contact_texts(design: ControllerDesign) -> Iterator[Assumption]:
    """Say what is touched under which controller."""
    for controller in design.controllers:
        if controller.contacts:
            contacts = " or ".join(controller.contacts)
            yield kinds.CONTACTS.says(
                f"While {controller.name} is active, nothing but {contacts} is touched.",
                f"{controller.name}: {contacts}",
            )


def ranges_text(touched: Iterable[Environment]) -> str:
    """Say in which ranges the parameters of environments are."""
    return "; ".join(
        f"{environment.name}: {name} in {_ends(interval)} {unit}"
        for environment in touched
        for (name, interval), unit in zip(
            environment.parameters.items(), environment.law.units(rotational=True), strict=True
        )
    )


def at_once_texts(touched: Iterable[Environment]) -> Iterator[Assumption]:
    """Say what is taken for granted where several environments are touched at once."""
    for environment in touched:
        names = " and ".join(part.name for part in environment.parts)
        if environment.each_losable:
            yield kinds.CONTACTS.says(
                f"{environment.name}: {names} are touched from one side, each from where its own "
                "surface is, and each may be lost on its own. The deflection counts from the "
                "surface that is met first; the stiffness is at least that of one alone, and at "
                "most the sum."
            )
        elif environment.parts:
            yield kinds.CONTACTS.says(
                f"{environment.name}: {names} are touched at once, at all times; their forces add "
                "up, and none of them is lost on its own."
            )


def rule_texts(rules: SwitchingSpec, noun: str) -> tuple[Assumption, ...]:
    """Say which switching signals are possible, between modes or controllers."""
    if rules.is_arbitrary:
        return (kinds.ANY_SIGNAL.says("Any switching signal is possible."),)
    texts = []
    for at, dwell in rules.dwell_times():
        which = f"{noun.capitalize()} {at[1]}" if at[1:] else f"Every {noun}"
        time = _time_text(dwell)
        sentence = f"{which} {_STAYS[at[0]]} {time}{_THEN[at[0]]}."
        texts.append(kinds.RULES.says(sentence, f"{_ENDS[at[0]]} {time}"))
    if rules.transitions is not None:
        only = f"changes only {_listed(rules.transitions)}"
        changes = only if rules.transitions else "never changes"
        texts.append(kinds.RULES.says(f"The {noun} {changes}."))
    else:
        texts.append(kinds.ANY_SIGNAL.says(f"Any {noun} may follow any other."))
    return tuple(texts)


def _time_text(dwell: DwellTime) -> str:
    unit = "step" if dwell.unit == "steps" and dwell.value == 1 else dwell.unit
    return f"{exact_text(dwell.value)} {unit}"


def scale_texts(scale: Fraction) -> tuple[Assumption, ...]:
    """Say by how much the ranges of the spec are stretched, unless they are as declared."""
    if scale == 1:
        return ()
    return (
        kinds.RANGE.says(
            f"All ranges of the spec are scaled about their nominal values by {scale}."
        ),
    )


def command_texts(command: str) -> Iterator[Assumption]:
    """Say in which unit the motor is commanded, where it is not the rpm of the thesis.

    Parameters
    ----------
    command : str
        That unit.
    """
    if command != THESIS_COMMAND:
        yield kinds.COMMAND_UNIT.says(
            f"{_TAKES}{command}: Kp of the motion controller is in "
            f"{command}/rad, Kd in {command}*s/rad."
        )


def command_in(statements: Iterable[str]) -> str:
    """Return the unit of commands that `command_texts` has put among the assumptions."""
    found = (re.match(_TAKES + "(.+?):", text) for text in statements)
    return next((match[1] for match in found if match), THESIS_COMMAND)


def identified_texts(spec: InteractionDesignSpec) -> Iterator[Assumption]:
    """Say what identified ranges hold, and what is doubtful about identified values."""
    from nrs_design.spec.plausible import unusual
    from nrs_design.spec.provenance import COVERS, MOTOR_COVERS

    if spec.actuator.range_covers is not None:
        covered = MOTOR_COVERS[spec.actuator.range_covers]
        said = f"hold {covered}{_since(spec.actuator)}"
        yield kinds.COVERAGE.says(f"The range of the actuator was identified to {said}.", covered)
    for name, environment in spec.environments.items():
        if environment.range_covers is not None:
            covered = COVERS[environment.range_covers]
            said = f"hold {covered}{_since(environment)}"
            yield kinds.COVERAGE.says(f"The range of {name} was identified to {said}.", covered)
        if environment.linearized_about is not None:
            about = environment.linearized_about
            yield kinds.LINEARIZED.says(
                f"{name} is the linearization about {about}: it holds for small motions there."
            )
    for at, item in spec.identified.items():
        if item.accept_doubt is not None and not item.doubts:
            sizes = "; ".join(text.partition(":")[0] for text in unusual(item))
            yield kinds.DOUBT.says(
                f"Sizes of {at[-1]} are unusual: {sizes}; accepted because: {item.accept_doubt}."
            )
        if item.doubts:
            why = item.accept_doubt
            end = "nothing says why that is accepted" if why is None else f"accepted because: {why}"
            yield kinds.DOUBT.says(
                f"The identification of {at[-1]} is in doubt: {'; '.join(item.doubts)}; {end}."
            )


def _since(item: IdentifiedRangesSpec) -> str:
    """Say what nobody can check of values that came without an id."""
    return "" if item.range_id else ", unless it has been changed by hand since"


def preload_texts(spec: InteractionDesignSpec, scale: Fraction) -> Iterator[Assumption]:
    """Say what linear ranges cover of power laws that are known within a preload.

    Parameters
    ----------
    spec : InteractionDesignSpec
        With the environments.
    scale : Fraction
        By how much their ranges are stretched: less than declared do not cover the law.
    """
    from nrs_design.models.contact import nonlinear_law_of

    for name, environment in spec.environments.items():
        law = nonlinear_law_of(environment)
        if law is None or environment.preload_range is None or name not in spec.touched:
            continue
        low, high = (end.text for end in environment.preload_range)
        if scale < 1:
            yield kinds.PRELOAD.says(
                f"{name} is {law.title}, and with ranges scaled below 1 that law is not covered: "
                "it is taken for a linear one."
            )
            continue
        yield kinds.PRELOAD.says(
            law.preload_text(name, low, high), f"{name}: deflection from {low} to {high}"
        )


def _parameter_text(parameter: UncertainParameter) -> Assumption:
    interval = parameter.interval
    if interval.low == interval.high:
        return kinds.RANGE.says(f"Parameter {parameter.name} is {exact_text(interval.low)}.")
    ends = _ends(interval)
    within = f"{parameter.name} in {ends}"
    if parameter.varies:
        sentence = f"Parameter {parameter.name} stays in {ends} and may change arbitrarily fast."
        return kinds.RANGE.says(sentence, within)
    return kinds.RANGE.says(
        f"Parameter {parameter.name} is unknown in {ends}, but constant: it has one value in all "
        "modes and at all times.",
        within,
    )


def _ends(interval: Interval) -> str:
    return f"[{exact_text(interval.low)}, {exact_text(interval.high)}]"


def _listed(transitions: Sequence[tuple[str, str]]) -> str:
    texts = [f"from {source} to {target}" for source, target in transitions]
    if len(texts) > MAX_LISTED:
        return f"along the {len(texts)} transitions that the spec lists"
    return ", ".join(texts)
