"""Assumptions about data, switching, ranges and given matrices."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import starmap
from typing import TYPE_CHECKING

from nrs_design.models.interval import Interval
from nrs_design.proof.assumption import Assumption
from nrs_design.proof.switching import Switching
from nrs_design.proof.text import exact_text
from nrs_design.spec import SwitchedSystemSpec, SwitchingSpec
from nrs_design.spec.switching import DwellTime
from nrs_design.spec.units import THESIS_COMMAND

if TYPE_CHECKING:
    from nrs_design.spec import InteractionDesignSpec
    from nrs_design.spec.build_plant import Preload
    from nrs_design.spec.provenance import IdentifiedRangesSpec

MAX_LISTED = 20
assume = Assumption.create
GIVEN_MATRICES = (assume("matrices.given"), assume("at-a-switch.any-signal", which="one"))
COMMAND_UNIT = "command-unit.unit"
# Sentence ids: for one mode or controller, and for every one.
_DWELL_IDS = {
    "dwell_time": ("rules.stays", "rules.all-stay"),
    "longest_dwell_time": ("rules.left", "rules.all-left"),
}


def assume_matrices(
    spec: SwitchedSystemSpec, parameters: Mapping[str, Interval], scale: Fraction
) -> tuple[Assumption, ...]:
    """Return the assumptions of a `switched-system` spec; the parameters are scaled already."""
    return (
        GIVEN_MATRICES[0],
        *starmap(_assume_parameter, parameters.items()),
        *assume_scale(scale),
        *_assume_switches(spec),
    )


def _assume_parameter(name: str, interval: Interval) -> Assumption:
    if interval.low == interval.high:
        return assume("range.value", name=name, value=exact_text(interval.low))
    kind = "range.varies" if interval.varies else "range.constant"
    return assume(kind, name=name, ends=interval.text)


def _assume_switches(spec: SwitchedSystemSpec) -> tuple[Assumption, ...]:
    if (rule := spec.misses) is not None:
        misses, steps = rule.window
        missed = assume("rules.misses", mode=rule.mode, at_most=misses, of=steps)
        return assume("at-a-switch.continuous", which="one"), missed
    if spec.switching.is_arbitrary and not spec.resets:
        return GIVEN_MATRICES[1:]
    jump = assume("at-a-switch.continuous", which="one")
    if spec.resets:
        switches = [(reset.source, reset.target) for reset in spec.resets]
        distinct = list(dict.fromkeys(switches))
        several = len(distinct) < len(switches) and "yes"
        jump = _listing("at-a-switch.resets", "at-a-switch.many-resets", distinct, several=several)
    return jump, *assume_rules(spec.switching, "mode")


def _listing(
    id: str, count_id: str, switches: Sequence[tuple[str, str]], **values: object
) -> Assumption:
    """Return an assumption that lists the switches, or counts more than `MAX_LISTED`."""
    if len(switches) > MAX_LISTED:
        return assume(count_id, count=len(switches), **values)
    return assume(id, switches=tuple(name for pair in switches for name in pair), **values)


def assume_rules(rules: SwitchingSpec, noun: str) -> tuple[Assumption, ...]:
    """Return the assumptions about switching signals; the noun is mode or controller."""
    if rules.is_arbitrary:
        return (assume("any-signal.all"),)
    found = []
    for (key, *names), dwell in rules.dwell_times():
        one, general = _DWELL_IDS[key]
        time = _time_text(dwell)
        found.append(
            assume(one, noun=noun, name=names[0], time=time)
            if names
            else assume(general, noun=noun, time=time)
        )
    if rules.transitions is None:
        return (*found, assume("any-signal.follow", noun=noun))
    if not rules.transitions:
        return (*found, assume("rules.never", noun=noun))
    ids = "rules.transitions", "rules.many-transitions"
    return (*found, _listing(*ids, rules.transitions, noun=noun))


def _time_text(dwell: DwellTime) -> str:
    unit = "step" if dwell.unit == "steps" and dwell.value == 1 else dwell.unit
    return f"{exact_text(dwell.value)} {unit}"


def assume_scale(scale: Fraction) -> tuple[Assumption, ...]:
    """Return the scale of the ranges, if it is not 1."""
    return () if scale == 1 else (assume("range.scaled", scale=scale),)


def find_command_unit(assumptions: Iterable[Assumption]) -> str:
    """Return the unit of the motor command that the assumptions state; rpm by default."""
    units = (dict(item.fields).get("unit", ()) for item in assumptions if item.id == COMMAND_UNIT)
    return next((unit for stated in units for unit in stated), THESIS_COMMAND)


def assume_data(spec: InteractionDesignSpec) -> Iterator[Assumption]:
    """Yield a mode logic with dwell times, and coverage of and doubts about identified values."""
    from nrs_design.spec.interaction_parts import INTERFACES
    from nrs_design.spec.plausible import unusual

    if spec.mode_logic is not None and not spec.switching.is_arbitrary:
        yield assume("logic.timer")
        yield assume("logic.any-signal")
    for key, drive in spec.drives.items():
        if drive.range_covers is not None:
            name = "robot" if key in INTERFACES else key
            yield _coverage("coverage.motor", name, f"motor-{drive.range_covers}", drive)
    for name, environment in spec.environments.items():
        if environment.range_covers is not None:
            yield _coverage("coverage.range", name, environment.range_covers, environment)
        if environment.linearized_about is not None:
            point = str(environment.linearized_about)
            yield assume("linearized.about", environment=name, about=point)
    for path, item in spec.identified.items():
        name, reason = path[-1], item.accept_doubt
        if item.doubts:
            kind = "doubt.listed" if reason is None else "doubt.accepted"
            yield assume(kind, name=name, doubts=tuple(item.doubts), why=reason)
        elif reason is not None:
            sizes = tuple(text.partition(":")[0] for text in unusual(item))
            yield assume("doubt.unusual", name=name, sizes=sizes, why=reason)


def _coverage(id: str, name: str, covered: str, item: IdentifiedRangesSpec) -> Assumption:
    return assume(id, name=name, covered=covered, since=not item.range_id and "unsigned")


def assume_preloads(preloads: Mapping[str, Preload], scale: Fraction) -> Iterator[Assumption]:
    """Yield the scope of linear ranges for nonlinear laws within a preload.

    Ranges that are stretched by less than declared do not cover the law.
    """
    for name, (law, low, high) in preloads.items():
        if scale < 1:
            yield assume("preload.scaled", environment=name, law=law.name, low=low, high=high)
        else:
            yield assume(f"preload.{law.name}", environment=name, low=low, high=high)


def assume_constants(switching: Switching) -> Iterator[Assumption]:
    """Yield the unknown but constant parameters of a design."""
    for parameter in switching.fixed_parameters:
        ends = f"[{exact_text(parameter.low)}, {exact_text(parameter.high)}] {parameter.unit}"
        yield assume("constant.value", name=parameter.name, ends=ends.rstrip())
