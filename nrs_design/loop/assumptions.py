"""What a statement takes for granted about matrices, switching, contacts, sensor and data."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

from nrs_design.axis import AxisType
from nrs_design.controllers.float32 import exact_decimal
from nrs_design.loop.assumption import Assumption, say
from nrs_design.loop.parameters import UncertainParameter
from nrs_design.models.interval import Interval
from nrs_design.proof.bounds import rounded_up
from nrs_design.proof.switching import Switching
from nrs_design.proof.text import exact_text
from nrs_design.spec import DwellTime, SwitchedSystemSpec, SwitchingSpec
from nrs_design.spec.units import THESIS_COMMAND

if TYPE_CHECKING:
    from nrs_design.controllers.controller_design import ControllerDesign
    from nrs_design.controllers.sensor import Sensor
    from nrs_design.models.actuator import ActuatorRanges
    from nrs_design.models.contact.environment import Environment
    from nrs_design.spec import InteractionDesignSpec
    from nrs_design.spec.operating import Preload
    from nrs_design.spec.provenance import IdentifiedRangesSpec

MAX_LISTED = 20
# What follows for inputs of zero, by whether contact may be lost: in the air, the deflection may
# stay anywhere.
REST = {
    False: "all modes then rest at one point, the state zero.",
    True: "all modes in contact then rest at one point, the state zero.",
}
UNCOUPLED = say("uncoupled.axes")
GIVEN_MATRICES = (say("matrices.given"), say("at-a-switch.any-signal", states="The state is"))
_SEVERAL = (
    " Where several resets lead from one mode to another, any one of them may happen, and always "
    "one of them does."
)
_STAYS = {
    "dwell_time": ("rules.stays", "at least"),
    "longest_dwell_time": ("rules.left", "at most"),
}


def assume_matrices(
    spec: SwitchedSystemSpec, parameters: Sequence[UncertainParameter], scale: Fraction
) -> tuple[Assumption, ...]:
    """Say what holds for a `switched-system` spec whose parameters are scaled already."""
    return (
        GIVEN_MATRICES[0],
        *map(_parameter_text, parameters),
        *scale_texts(scale),
        *_switch_texts(spec),
    )


def _switch_texts(spec: SwitchedSystemSpec) -> tuple[Assumption, ...]:
    if (rule := spec.misses) is not None:
        within, (most, of) = str(rule), rule.window
        said = say("rules.misses", within, mode=rule.mode, at_most=most, of=of)
        return say("at-a-switch.continuous", states="The state is"), said
    if spec.switching.is_arbitrary and not spec.resets:
        return GIVEN_MATRICES[1:]
    jump = say("at-a-switch.continuous", states="The state is")
    if spec.resets:
        switches = [(reset.source, reset.target) for reset in spec.resets]
        distinct = list(dict.fromkeys(switches))
        several = _SEVERAL if len(distinct) < len(switches) else ""
        jump = say("at-a-switch.resets", switches=_listed(distinct), several=several)
    return jump, *rule_texts(spec.switching, "mode")


def contact_texts(design: ControllerDesign) -> Iterator[Assumption]:
    """Say what is touched under which controller."""
    for c in design.controllers:
        if c.contacts:
            contacts = " or ".join(c.contacts)
            bound = f"{c.name}: {contacts}"
            yield say("contacts.controller", bound, controller=c.name, contacts=contacts)


def ranges_text(environments: Iterable[Environment], axis: AxisType) -> str:
    """Say in which ranges the parameters of environments are."""
    return "; ".join(
        f"{environment.name}: {name} in {_ends(interval)} {axis.unit(unit)}"
        for environment in environments
        for (name, interval), unit in zip(
            environment.parameters.items(), environment.law.units(rotational=True), strict=True
        )
    )


def motor_text(ranges: ActuatorRanges, axis: AxisType) -> str:
    """Say where gain and time constant of the motor are."""
    texts = (
        f"its {name} {interval_text(interval)} {unit}"
        for name, interval, unit in (
            ("gain", ranges.gain, f"{axis.unit('rad/s')}/{ranges.command}"),
            ("time constant", ranges.time_constant, "s"),
        )
    )
    return " and ".join(texts)


def interval_text(interval: Interval) -> str:
    """Say where a number is, after its name."""
    if interval.low == interval.high:
        return f"is {exact_text(interval.low)}"
    return f"stays in [{exact_text(interval.low)}, {exact_text(interval.high)}]"


def at_once_texts(environments: Iterable[Environment]) -> Iterator[Assumption]:
    """Say what is taken for granted where several environments are touched at once."""
    for environment in environments:
        if environment.parts:
            parts = " and ".join(part.name for part in environment.parts)
            how = "one-side" if environment.each_losable else "at-once"
            yield say(f"contacts.{how}", environment=environment.name, parts=parts)


def rule_texts(rules: SwitchingSpec, noun: str) -> tuple[Assumption, ...]:
    """Say which switching signals are possible, between modes or controllers."""
    if rules.is_arbitrary:
        return (say("any-signal.all"),)
    texts = []
    for at, dwell in rules.dwell_times():
        which = f"{noun.capitalize()} {at[1]}" if at[1:] else f"Every {noun}"
        (name, end), time = _STAYS[at[0]], _time_text(dwell)
        texts.append(say(name, f"{end} {time}", which=which, time=time))
    if rules.transitions is None:
        return (*texts, say("any-signal.follow", noun=noun))
    listed = rules.transitions
    changes = f"changes only {_listed(listed)}" if listed else "never changes"
    return (*texts, say("rules.transitions", noun=noun, changes=changes))


def _time_text(dwell: DwellTime) -> str:
    unit = "step" if dwell.unit == "steps" and dwell.value == 1 else dwell.unit
    return f"{exact_text(dwell.value)} {unit}"


def scale_texts(scale: Fraction) -> tuple[Assumption, ...]:
    """Say by how much the ranges of the spec are stretched, unless they are as declared."""
    return () if scale == 1 else (say("range.scaled", scale=scale),)


def points_texts(points: str, *, remembers: bool) -> tuple[Assumption, ...]:
    """Say at which points of the ranges the modes are, unless they are about all of them.

    What `remembers` is always looked at in one place.
    """
    if not points:
        return ()
    but = ", and those of what remembers at their nominal values" if remembers else ""
    if points == "ends":
        return (say("range.points", points="ends", but=but),)
    return (say("range.points", points="nominal values", but=""),)


def command_texts(command: str, axis: AxisType) -> Iterator[Assumption]:
    """Say in which unit the motor is commanded, where it is not the rpm of the thesis."""
    if command != THESIS_COMMAND:
        yield say("command-unit.unit", unit=command, per=axis.unit("rad"))


def command_in(statements: Iterable[str]) -> str:
    """Return the unit of commands that `command_texts` has put among the assumptions."""
    before, _, after = say("command-unit.unit", unit="\0", per="").partition("\0")
    pattern = f"{re.escape(before)}(.+?){re.escape(after[0])}"
    found = (re.match(pattern, text) for text in statements)
    return next((match[1] for match in found if match), THESIS_COMMAND)


def identified_texts(spec: InteractionDesignSpec) -> Iterator[Assumption]:
    """Say what identified ranges hold, and what is doubtful about identified values."""
    from nrs_design.spec.interaction_parts import INTERFACES
    from nrs_design.spec.plausible import unusual
    from nrs_design.spec.provenance import COVERS, MOTOR_COVERS

    for key, drive in spec.drives.items():
        name = "robot" if key in INTERFACES else key
        if drive.range_covers is not None:
            yield _coverage(f"the {name}", MOTOR_COVERS[drive.range_covers], drive)
    for name, environment in spec.environments.items():
        if environment.range_covers is not None:
            yield _coverage(name, COVERS[environment.range_covers], environment)
        if environment.linearized_about is not None:
            yield say("linearized.about", environment=name, about=environment.linearized_about)
    for at, item in spec.identified.items():
        name, why = at[-1], item.accept_doubt
        if item.doubts:
            end = "nothing says why that is accepted" if why is None else f"accepted because: {why}"
            yield say("doubt.listed", name=name, doubts="; ".join(item.doubts), end=end)
        elif why is not None:
            sizes = "; ".join(text.partition(":")[0] for text in unusual(item))
            yield say("doubt.unusual", name=name, sizes=sizes, why=why)


def _coverage(name: str, covered: str, item: IdentifiedRangesSpec) -> Assumption:
    # Nobody can check values that came without an id.
    since = "" if item.range_id else ", unless it has been changed by hand since"
    return say("coverage.range", covered, name=name, covered=covered, since=since)


def preload_texts(preloads: Mapping[str, Preload], scale: Fraction) -> Iterator[Assumption]:
    """Say what linear ranges cover of laws that are known within a preload.

    Ranges that are stretched by less than declared do not cover the law.
    """
    for name, (law, low, high) in preloads.items():
        if scale < 1:
            yield say("preload.scaled", environment=name, law=law.title)
        else:
            bound = f"{name}: deflection from {low} to {high}"
            yield say("preload.law", bound, text=law.preload_text(name, low, high))


def sensor_texts(
    sensor: Sensor, period: Fraction | None, *, disturbed: bool, axis: AxisType = AxisType.ROTARY
) -> Iterator[Assumption]:
    """Say how the law gets the force, and what a proof leaves out of its errors.

    The period is that of the processor in s, if there is one; `disturbed`: bounds on disturbances
    are stated.
    """
    if sensor.filter is not None:
        order = sensor.filter.order
        lags = "one lag" if order == 1 else f"{order} equal lags in a row"
        if period is None:
            yield say("sensor.filter", lags=lags, pole=exact_decimal(sensor.filter.pole))
        else:
            step = sensor.filter.discretize(period)
            p, q = exact_decimal(step.p), exact_decimal(step.q)
            yield say("sensor.sampled-filter", lags=lags, p=p, q=q)
    if sensor.errors:
        unit = axis.unit("N*m")
        lasting = rounded_up(sensor.lasting, unit)
        parts = "; ".join(f"{name}: {rounded_up(e, unit)}" for name, e in sensor.errors.items())
        which = "sensor.errors-disturbed" if disturbed else "sensor.errors"
        yield say(which, lasting, lasting=lasting, parts=parts)
    if sensor.carries:
        yield say("sensor.tool", "accelerations of the tool far below that of gravity")
    if sensor.noisy:
        yield say("sensor.noise", "none")


def logic_texts(spec: InteractionDesignSpec) -> Iterator[Assumption]:
    """Say what keeps the rules of switching, where they are those of a mode logic."""
    if spec.mode_logic is not None and not spec.switching.is_arbitrary:
        yield say("logic.timer")
        yield say("logic.any-signal")


def constant_texts(switching: Switching) -> Iterator[Assumption]:
    """Say which parameters of a design do not change."""
    for parameter in switching.fixed_parameters:
        name, unit = parameter.name, f" {parameter.unit}" * bool(parameter.unit)
        ends = f"[{exact_text(parameter.low)}, {exact_text(parameter.high)}]{unit}"
        yield say("constant.value", f"{name} in {ends}", name=name, ends=ends)


def _parameter_text(parameter: UncertainParameter) -> Assumption:
    interval, name = parameter.interval, parameter.name
    if interval.low == interval.high:
        return say("range.value", name=name, value=exact_text(interval.low))
    ends = _ends(interval)
    how = "range.varies" if parameter.varies else "range.constant"
    return say(how, f"{name} in {ends}", name=name, ends=ends)


def _ends(interval: Interval) -> str:
    return f"[{exact_text(interval.low)}, {exact_text(interval.high)}]"


def _listed(transitions: Sequence[tuple[str, str]]) -> str:
    texts = [f"from {source} to {target}" for source, target in transitions]
    if len(texts) > MAX_LISTED:
        return f"along the {len(texts)} transitions that the spec lists"
    return ", ".join(texts)
