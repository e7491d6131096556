"""In which places a spec asks for less, or takes more for granted, than another one did.

The two are compared by what they mean: as models, defaults filled in. That something is weaker is
decided by rules about the kind of a place: a range that no longer covers the other, a limit of a
goal, something that is not said any more. What makes another robot or another law, such as the gain
of a motor, is neither more nor less. Whatever else cannot be compared is weaker, and so is another
value where nobody has said which of two asks for more.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields, is_dataclass
from fractions import Fraction

from pydantic import BaseModel

from nrs_design.errors import SpecError
from nrs_design.proof.text import exact_text, quoted
from nrs_design.spec.document import Data
from nrs_design.spec.edits import in_one_line
from nrs_design.spec.exact import is_number, parse_exact
from nrs_design.spec.places import dotted
from nrs_design.spec.quantity import Quantity, is_less
from nrs_design.spec.quantity_fields import Times
from nrs_design.spec.switching import ARBITRARY, DwellTime, SwitchingSpec

# What is assumed of switching, and why a doubt does not count: with it, less is shown.
_ASSUMED = frozenset(
    {"dwell_time", "longest_dwell_time", "transitions", "mode_logic", "accept_doubt", "misses"}
)
# What a proof is not about: words for people, where values come from, how long is searched.
_BESIDE = frozenset({"title", "description", "provenance", "certification", "design"})
# Parts that make another robot, another law or another system, beside what is said of goals and of
# contacts: neither more nor less than those of before.
_ANOTHER = frozenset(
    {
        *("name", "actuator", "motion_loop", "idle_states", "anti_windup", "controllers"),
        *("velocity_interface", "position_interface", "torque_interface", "modes", "resets"),
        *("gravity", "base_tilt", "legs", "platform", "drive", "control", "balance"),
    }
)
_ANOTHER_BELOW = (("sensor", "filter"), ("sampling", "admittance"))
# Words for people.
_WORDS = frozenset({"accept_doubt", "range_covers", "linearized_about"})
_WANTED = frozenset({"desired_impedance", "desired_impedance_ratio"})
_ASKED = _WANTED | {"goals", "contacts", "environment"}
# Parts whose keys are names that somebody has given, and no words of ours.
_NAMED = frozenset({"environments", "controllers", "parameters", "modes", "scenarios"})
_OF_MODES = frozenset({"dwell_time", "longest_dwell_time", "hold"})
# Limits below which something must stay, and above which: of a goal, a scenario, an assumption.
_AT_MOST = frozenset({"peak_torque", "dwell_time", "hold", "of"})
# How many deadlines may be missed is what must be borne.
_AT_LEAST = frozenset(
    {"decay_rate", "delay", "initial_force", "longest_dwell_time", "at_most", "consecutive"}
)
_LIMITS = "limits"
# What a motor gives at most: to count on more is weaker.
_HIGHEST = ([_LIMITS, "torque"], [_LIMITS, "command"])
# Parts whose numbers must be borne: disturbances, errors of signals, the age of a sample. Of the
# sensor, those below it are parts of the loop.
_BORNE = frozenset({"disturbances", "sampling"})
_ERRORS = frozenset({"signals", "errors"})
# Of two words, the one that asks for more; what stands there unless it is said, in two of them.
_STRONGER = {
    "contact": "losable",
    "switching": "arbitrary",
    "varies": "true",
}
_UNSAID = frozenset({"contact", "varies"})
# Lists that say what may occur; whatever is left out is not shown.
_SETS = frozenset({"contacts", "doubts"})
# What an environment says about its values, and not of what is touched.
_ABOUT_VALUES = _BESIDE | {
    *("doubts", "accept_doubt", "range_covers", "range_id", "linearized_about"),
}
# Ranges that stand alone, as lists of their ends.
_RANGES = frozenset({"range", "band", "delay", "latency", "dead_time", "preload"})

Place = tuple[str | int, ...]


@dataclass(frozen=True, slots=True)
class Change:
    """One place where two specs differ."""

    at: Place  # Keys that lead to it
    message: str  # What has changed; one line
    # Whether less is asked for, or more taken for granted, than before. Otherwise, it is stronger,
    # or neither.
    weaker: bool


def meaning_of(value: object) -> Data:
    """Return what a part of a spec says, defaults filled in: however it is written, the same."""
    if isinstance(value, SwitchingSpec) and value.is_arbitrary:
        return ARBITRARY
    if isinstance(value, Times):
        ends = (value.shortest.text, value.longest.text)
        return _ranged({"range": ends, "varies": meaning_of(value.varies)})
    if isinstance(value, BaseModel):
        fields_of = type(value).model_fields.items()
        named = ((f.alias or name, getattr(value, name)) for name, f in fields_of)
        said = {key: meaning_of(item) for key, item in named if item is not None and item != ""}
        return _ranged(said) if "nominal" in said else said
    if isinstance(value, Quantity | DwellTime):
        return value.text
    if isinstance(value, Fraction):
        return exact_text(value)
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, dict):
        return {str(key): meaning_of(item) for key, item in value.items()}
    if isinstance(value, tuple | list):
        return tuple(meaning_of(item) for item in value)
    if is_dataclass(value):
        return {field.name: meaning_of(getattr(value, field.name)) for field in fields(value)}
    return str(value)


def _ranged(said: dict[str, Data]) -> Data:
    """Return one value as its text, whose range is that value, and more of them as they are."""
    known = _without(said, {"varies"}).values()
    points = {end for item in known for end in (item if isinstance(item, tuple) else (item,))}
    point = points.pop() if len(points) == 1 else None
    return point if isinstance(point, str) else said


def find_changes(before: Data, after: Data) -> Iterator[Change]:
    """Yield where a spec differs from an earlier one."""
    yield from _changes(_written_out(before, after), _written_out(after, before), ())


def _written_out(said: Data, other: Data) -> Data:
    """Write out what holds unsaid, where the other spec says it or changes what it follows from.

    A controller touches its own environment, and has the goals of the whole spec. The first one is
    in force in a run.
    """
    if not isinstance(said, dict) or not isinstance(other, dict):
        return said
    said = _with_control(said)
    controllers, others = said.get("controllers"), other.get("controllers")
    if not isinstance(controllers, dict) or not isinstance(others, dict):
        return said
    goals = said.get("goals")
    found: dict[str, Data] = {}
    for name, controller in controllers.items():
        beside = others.get(name)
        found[name] = controller
        if not isinstance(controller, dict) or not isinstance(beside, dict):
            continue
        whole = dict(controller)
        environment = whole.get("environment")
        moved = beside.get("contacts") or beside.get("environment") != environment
        if isinstance(environment, str) and not whole.get("contacts") and moved:
            whole["contacts"] = (environment,)
        own, theirs = whole.get("goals", {}), beside.get("goals")
        if isinstance(goals, dict) and isinstance(own, dict) and isinstance(theirs, dict):
            common = {key: goals[key] for key in theirs if key in goals and key not in own}
            if common:
                whole["goals"] = own | common
        found[name] = whole
    return said | {"controllers": found}


def _with_control(said: dict[str, Data]) -> dict[str, Data]:
    """Write out which controller is in force in every run; what contact brings about, in order."""
    runs, controllers = said.get("scenarios"), said.get("controllers")
    if not isinstance(runs, dict) or not isinstance(controllers, dict):
        return said
    first: Data = (
        {"logic": "mode-logic"} if "mode_logic" in said else {"fixed": next(iter(controllers), "")}
    )
    found: dict[str, Data] = {}
    for name, run in runs.items():
        found[name] = run
        if isinstance(run, dict):
            control = run.get("control", first)
            contact = control.get("contact") if isinstance(control, dict) else None
            if isinstance(control, dict) and isinstance(contact, dict):
                control = control | {"contact": tuple(contact.items())}
            found[name] = run | {"control": control}
    return said | {"scenarios": found}


def _changes(before: Data, after: Data, at: Place) -> Iterator[Change]:
    key = next((part for part in reversed(at) if isinstance(part, str)), "")
    if before == after:
        return
    was, now = _range_of(before, key), _range_of(after, key)
    two_values = isinstance(before, str) and isinstance(after, str) and not _is_touched(at)
    if was is not None and now is not None and not two_values:
        yield from _of_ranges(was, now, at, (_said(before), _said(after)))
        if isinstance(before, dict) and isinstance(after, dict):
            beside = {"range", "nominal"}
            if not is_less(*was):
                # One value has no way to vary.
                beside.add("varies")
            yield from _of_keys(_without(before, beside), _without(after, beside), at)
    elif isinstance(before, dict) and isinstance(after, dict):
        yield from _of_keys(before, after, at)
    elif isinstance(before, tuple) and isinstance(after, tuple):
        yield from _of_lists(before, after, at, key)
    else:
        weaker = _is_weaker(before, after, at)
        yield Change(at, f"{_name(at)}: {_said(before)} before, {_said(after)} now", weaker)


def _of_keys(before: dict[str, Data], after: dict[str, Data], at: Place) -> Iterator[Change]:
    for key, said in before.items():
        here = (*at, key)
        if key in after:
            yield from _changes(said, after[key], here)
        else:
            keys = _keys(here)
            weaker = not _is_assumed(keys) and _BESIDE.isdisjoint(keys)
            if _is_unsaid(keys):
                weaker &= _word(said) == _STRONGER[keys[-1]]
            yield Change(here, f"{_name(here)} is gone, {_said(said)} before", weaker)
    for key, said in after.items():
        if key not in before:
            here = (*at, key)
            keys = _keys(here)
            weaker = _is_assumed(keys)
            weaker |= _is_unsaid(keys) and _word(said) != _STRONGER[keys[-1]]
            weaker |= _is_instead(keys)
            yield Change(here, f"{_name(here)} is new: {_said(said)}", weaker)


def _is_unsaid(keys: Sequence[str]) -> bool:
    """Tell whether something holds where nothing is said; other keys may be named `contact`."""
    return keys[-1] in _UNSAID and keys not in (["sensor", "contact"],)


def _is_instead(keys: Sequence[str]) -> bool:
    """Tell whether something else holds where nothing is said, and nobody knows which asks more.

    All but limits and errors makes another run; unsaid, a force is sampled with the motion loop.
    """
    run = keys[0] == "scenarios" and not {*keys[1:2]} <= {"limits", "errors", "title"}
    goal = "goals" in keys and keys[-1] == "environment"
    return run or goal or keys[-1] in _WANTED | {"outer_period"}


def _is_assumed(keys: Sequence[str]) -> bool:
    """Tell whether a part is assumed of switching; that a sampled loop misses must be borne."""
    return not (_ASSUMED - {"misses" if "sampling" in keys else ""}).isdisjoint(keys)


def _of_lists(
    before: tuple[Data, ...], after: tuple[Data, ...], at: Place, key: str
) -> Iterator[Change]:
    """Compare lists: what may occur as sets, named items by name, others by place."""
    if key == "transitions" or key in _SETS:
        lost = [item for item in before if item not in after]
        new = [item for item in after if item not in before]
        for what, items in (("no longer has", lost), ("now has", new)):
            for item in items:
                yield Change(at, f"{_name(at)} {what} {_said(item)}", items is lost)
        return
    names = [_named(items) for items in (before, after)]
    if names[0] and names[1]:
        yield from _of_keys(names[0], names[1], at)
        return
    for index, pair in enumerate(zip(before, after, strict=False)):
        yield from _changes(*pair, (*at, index))
    for index, item in enumerate(before[len(after) :], len(after)):
        yield Change((*at, index), f"{_name((*at, index))} is gone, {_said(item)} before", True)
    for index, item in enumerate(after[len(before) :], len(before)):
        weaker = _is_instead(_keys(at))
        yield Change((*at, index), f"{_name((*at, index))} is new: {_said(item)}", weaker)


def _named(items: tuple[Data, ...]) -> dict[str, Data]:
    """Return items by their names; nothing if one has none."""
    found: dict[str, Data] = {
        str(item["name"]): item for item in items if isinstance(item, dict) and "name" in item
    }
    return found if len(found) == len(items) else {}


def _of_ranges(
    before: tuple[Quantity, Quantity],
    after: tuple[Quantity, Quantity],
    at: Place,
    said: tuple[str, str],
) -> Iterator[Change]:
    """Compare what values are covered: less than before is weaker, if it was more than one."""
    (low, high), (new_low, new_high) = before, after
    if low.dimension != new_low.dimension:
        yield Change(at, f"{_name(at)}: {said[0]} before, {said[1]} now", True)
        return
    was_point = not is_less(low, high)
    covers = not is_less(low, new_low) and not is_less(new_high, high)
    same = covers and not is_less(new_low, low) and not is_less(high, new_high)
    if not (same and said[0] == said[1]):
        message = f"{_name(at)}: {said[0]} before, {said[1]} now"
        lower = _is_borne(_keys(at)) and is_less(new_high, high)
        weaker = not covers and (not was_point or _is_touched(at) or lower)
        yield Change(at, message + weaker * " (values of before are not covered)", weaker)


def _is_weaker(before: Data, after: Data, at: Place) -> bool:
    """Tell whether one value, or one way to say it, asks for less than another."""
    path = _keys(at)
    key = path[-1] if path else ""
    if not _BESIDE.isdisjoint(path):
        return False
    if stronger := _STRONGER.get(key):
        return _word(after) != stronger
    if _is_another(path):
        return False
    if isinstance(before, str) is not isinstance(after, str) or (
        _is_touched(at) and key == "model"
    ):
        return True
    goal = "goals" in path
    most = (goal and key.startswith("max_")) or not _AT_MOST.isdisjoint(path) or _is_limit(path)
    borne = _is_borne(path) and key not in _AT_MOST
    least = (goal and key.startswith("min_")) or not _AT_LEAST.isdisjoint(path) or borne
    was, now = _number(before), _number(after)
    if was is None or now is None or was.dimension != now.dimension or not (most or least):
        return True
    return (most and is_less(was, now)) or (least and is_less(now, was))


def _is_another(path: list[str]) -> bool:
    """Tell whether a part makes another robot, law or system, and asks for nothing."""
    if tuple(path[:2]) in _ANOTHER_BELOW or (path[-1:] and path[-1] in _WORDS):
        return True
    return bool(path) and path[0] in _ANOTHER and _ASKED.isdisjoint(path)


def _keys(at: Place) -> list[str]:
    """Return the words of ours on the way to a place, without names that somebody has given."""
    named = [i + 1 for i, part in enumerate(at[:2]) if part in (_OF_MODES if i else _NAMED)]
    return [part for i, part in enumerate(at) if isinstance(part, str) and i not in named]


def _word(said: Data) -> Data:
    return said.lower() if isinstance(said, str) else said


def _is_touched(at: Place) -> bool:
    """Tell whether a place says what is touched, words for people aside.

    A proof for one value says nothing of another one, not even where there is no range.
    """
    return at[:1] == ("environments",) and len(at) > 2 and at[2] not in _ABOUT_VALUES


def _is_borne(path: list[str]) -> bool:
    """Tell whether a number says how much must be borne: a proof for less is a proof of less."""
    return (
        path[0] in _BORNE
        or (path[0] == "sensor" and len(path) == 2)
        or not _ERRORS.isdisjoint(path)
        or path in ([_LIMITS, "bandwidth"], ["scenarios", "duration"])
    )


def _is_limit(path: list[str]) -> bool:
    """Tell whether a place is a limit that a scenario must keep, or the one of the torque."""
    return (_LIMITS in path and "scenarios" in path) or path in _HIGHEST


def _range_of(said: Data, key: str) -> tuple[Quantity, Quantity] | None:
    """Return the ends of what is said of a value with a range; None if that is something else."""
    if isinstance(said, dict) and "range" in said and "nominal" not in said:
        return _range_of(said["range"], "range")
    if isinstance(said, dict) and "nominal" in said:
        ends = said.get("range", (said["nominal"], said["nominal"]))
        return _range_of(ends, "range")
    if isinstance(said, tuple) and len(said) == 2 and key in _RANGES:
        low, high = map(_number, said)
        return None if low is None or high is None else (low, high)
    if isinstance(said, str):
        value = _number(said)
        return None if value is None else (value, value)
    return None


def _number(said: Data) -> Quantity | None:
    """Return a number with its unit, if that is what is said; without one, its unit is 1."""
    if not isinstance(said, str):
        return None
    number, _, unit = said.partition(" ")
    unit = "1" if unit.strip() in ("step", "steps") else unit
    try:
        value: Fraction | None = parse_exact(number) if is_number(number) else None
        return None if value is None else Quantity(said, value, unit.strip() or "1")
    except SpecError:
        return None


def _without(said: dict[str, Data], keys: set[str]) -> dict[str, Data]:
    return {key: value for key, value in said.items() if key not in keys}


def _name(at: Place) -> str:
    return dotted(at) or "the spec"


def _said(said: Data) -> str:
    """Return what is said as one short text."""
    if isinstance(said, dict) and "nominal" in said and "range" in said:
        return quoted(f"{in_one_line(said['nominal'])} in {in_one_line(said['range'])}")
    return quoted(in_one_line(said))
