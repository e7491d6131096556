"""Places in which a spec asks for less, or assumes more, than an earlier one.

The two are compared as they are read: field by field, defaults filled in, however it is written.
Every field declares which of two values asks for more (`nrs_design.spec.model.Stronger`). What
cannot be compared is weaker, and so is another value where nobody knows which of two asks for more.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from nrs_design.proof.text import exact_text, quoted
from nrs_design.spec.controllers import ControllerSpec
from nrs_design.spec.expression import Affine
from nrs_design.spec.goals import GoalsSpec
from nrs_design.spec.interaction_parts import AbstractInteractionSpec
from nrs_design.spec.model import Declared, SpecModel, Stronger, declared_in
from nrs_design.spec.parameters import ParameterSpec
from nrs_design.spec.places import dotted
from nrs_design.spec.preload import ExponentSpec
from nrs_design.spec.quantity import Quantity, is_less
from nrs_design.spec.quantity_fields import RangedQuantity, Times
from nrs_design.spec.scenarios import ControlSpec
from nrs_design.spec.switching import DwellTime, SwitchingSpec

Place = tuple[str | int, ...]
Ranged = RangedQuantity | ExponentSpec | ParameterSpec
_RANGES = ("wider", "farther", "holding")


@dataclass(frozen=True, slots=True)
class Change:
    """One place where two specs differ."""

    key_path: Place  # Keys that lead to it
    message: str  # The change in one line
    # True: less is asked for, or more is assumed, than before. False: stronger, or neither.
    weaker: bool


def find_changes(before: SpecModel, after: SpecModel) -> Iterator[Change]:
    """Yield where a spec differs from an earlier one."""
    whole = _written_out(before, after), _written_out(after, before)
    yield from _changes(*whole, (), Declared("unknown", "nothing"))


def _written_out(said: SpecModel, other: SpecModel) -> SpecModel:
    """Write out what holds unsaid: who is in force in a run, and goals that the other replaces."""
    if not (
        isinstance(said, AbstractInteractionSpec) and isinstance(other, AbstractInteractionSpec)
    ):
        return said
    first = ControlSpec(fixed=next(iter(said.controllers)))
    unsaid = first if said.mode_logic is None else ControlSpec(logic="mode-logic")
    runs = {
        name: run.model_copy(update={"control": _in_order(run.control or unsaid)})
        for name, run in said.scenarios.items()
    }
    controllers = {
        name: _with_goals(controller, other.controllers.get(name), said.goals)
        for name, controller in said.controllers.items()
    }
    return said.model_copy(update={"scenarios": runs, "controllers": controllers})


def _in_order(control: ControlSpec) -> ControlSpec:
    """Return the rules of the active controller; the first contact is active at the start."""
    contact = None if control.contact is None else tuple(control.contact.items())
    return control.model_copy(update={"contact": contact})


def _with_goals(
    controller: ControllerSpec, beside: ControllerSpec | None, goals: GoalsSpec | None
) -> ControllerSpec:
    """Return a controller with the common goals of the spec that its counterpart states itself.

    So has a controller without goals of its own, of whatever type.
    """
    theirs = None if beside is None else beside.goals
    own, whole, replaced = (
        {} if part is None else dict(part.given()) for part in (controller.goals, goals, theirs)
    )
    common = {key: whole[key] for key in replaced if key in whole and key not in own}
    if not common:
        return controller
    written = GoalsSpec.model_construct().model_copy(update=own | common)
    return controller.model_copy(update={"goals": written})


def _changes(before: object, after: object, at: Place, how: Declared) -> Iterator[Change]:
    """Compare two values; None for a missing one."""
    if before == after:
        return
    stronger, unsaid = how
    was, now = (_parts(value, stronger) for value in (before, after))
    if isinstance(stronger, tuple):
        yield _change(before, after, at, stronger.index(after) < stronger.index(before))
    elif before is None or after is None:
        weaker = unsaid != ("nothing" if before is None else "most")
        yield _change(before, after, at, weaker and stronger != "beside")
    elif _is_arbitrary(before) is not _is_arbitrary(after):
        yield _change(before, after, at, _is_arbitrary(before))
    elif was is not None and now is not None:
        known = _declared(after) | _declared(before)
        for key in sorted({**was, **now}, key=lambda key: key not in was):
            yield from _changes(was.get(key), now.get(key), (*at, key), known.get(key, how))
    elif stronger == "whole" and isinstance(before, tuple) and isinstance(after, tuple):
        for what, items, others in (("no longer has", before, after), ("now has", after, before)):
            for item in (item for item in items if item not in others):
                yield Change(at, f"{dotted(at)} {what} {_said(item)}", items is before)
    else:
        yield from _of_values(before, after, at, stronger)


def _of_values(
    before: object, after: object, at: Place, stronger: Stronger | None
) -> Iterator[Change]:
    """Compare two numbers, ranges or words."""
    (_, *was), (_, *now) = (points := [_points(value) for value in (before, after)])
    single = [_is_single(value) for value in (before, after)]
    if [*map(_exact, points[0])] != [*map(_exact, points[1])]:
        change = _change(before, after, at, _is_weaker(was, now, stronger))
        compared = _less(was[0], now[0]) is not None and stronger in _RANGES
        if change.weaker and compared and (stronger == "holding" or not all(single)):
            message = f"{change.message} (values of before are not covered)"
            change = replace(change, message=message)
        yield change
    varied, varies = (getattr(value, "varies", True) for value in (before, after))
    # One value has no way to vary.
    if varied != varies and not any(single):
        yield _change(varied, varies, (*at, "varies"), varied)


def _change(before: object, after: object, at: Place, weaker: bool) -> Change:
    if before is None:
        said = f" is new: {_said(after)}"
    elif after is None:
        said = f" is gone, {_said(before)} before"
    else:
        said = f": {_said(before)} before, {_said(after)} now"
    return Change(at, (dotted(at) or "the spec") + said, weaker)


def _is_weaker(before: list[Any], after: list[Any], stronger: Stronger | None) -> bool:
    """Tell whether a range asks for less than another; a value is a range of no width."""
    (low, high), (new_low, new_high) = before, after
    if stronger == "larger":
        return _less(new_low, low) is not False
    if stronger == "smaller":
        return _less(low, new_low) is not False
    if stronger not in _RANGES:
        return stronger not in ("neither", "beside")
    if _less(low, new_low) is False and _less(new_high, high) is False:
        return False
    if stronger == "holding" or _exact(low) != _exact(high):
        return True
    if stronger == "farther":
        return _less(new_high, high) is not False
    # Another single value is neither.
    return _exact(new_low) != _exact(new_high) and _less(low, new_low) is None


def _parts(value: object, stronger: object) -> dict[Any, object] | None:
    """Return the parts of a value, by keys or indices; None for a single value or range."""
    if isinstance(value, dict):
        return value
    if isinstance(value, Affine):
        return {"constant": value.constant, "slopes": value.slopes}
    if isinstance(value, SpecModel) and not isinstance(value, Ranged):
        return _fields(value)
    if not isinstance(value, tuple) or stronger == "whole" or stronger in _RANGES:
        return None
    names = [getattr(item, "name", None) for item in value]
    return dict(enumerate(value) if None in names else zip(names, value, strict=True))


def _fields(model: SpecModel) -> dict[str, object]:
    """Return what a model says, by the keys of the file."""
    keys = {name: field.alias for name, field in type(model).model_fields.items()}
    return {keys.get(k) or k: item for k, item in model if item is not None and item != ""}


def _declared(part: object) -> dict[str, Declared]:
    return declared_in(type(part)) if isinstance(part, SpecModel) else {}


def _is_arbitrary(value: object) -> bool:
    return isinstance(value, SwitchingSpec) and value.is_arbitrary


def _points(value: object) -> tuple[Any, Any, Any]:
    """Return the value for the design, and both ends of the covered range."""
    if isinstance(value, Ranged):
        return value.nominal, *value.range
    low, high = value[:2] if isinstance(value, tuple) else (value, value)
    return low, low, high


def _is_single(value: object) -> bool:
    _, low, high = map(_exact, _points(value))
    return low == high


def _exact(value: object) -> object:
    """Return a normal form, equal for all ways to write one value."""
    if isinstance(value, Quantity):
        return value.dimension, value.pi_power if value.value else 0, value.rational_part
    return (value.unit, value.value) if isinstance(value, DwellTime) else value


def _less(a: object, b: object) -> bool | None:
    """Tell whether a number is less than another one; None if the two cannot be compared."""
    if isinstance(a, Quantity) and isinstance(b, Quantity):
        return is_less(a, b) if a.dimension == b.dimension else None
    if isinstance(a, DwellTime) and isinstance(b, DwellTime):
        return a.value < b.value if a.unit == b.unit else None
    if isinstance(a, Fraction | int) and isinstance(b, Fraction | int):
        return a < b
    return None


def _said(value: object) -> str:
    """Return a value as one short text."""
    if isinstance(value, Ranged) and not _is_single(value):
        return quoted(f"{_text(value.nominal)} in {_text(value.range)}")
    return quoted(_text(value))


def _text(value: object) -> str:
    """Write a value in one line."""
    if isinstance(value, Quantity | DwellTime):
        return value.text
    if isinstance(value, Fraction):
        return exact_text(value)
    if isinstance(value, bool):
        return str(value).lower()
    if _is_arbitrary(value):
        return str(value)
    if isinstance(value, Ranged | Times) and _is_single(value):
        return _text(_points(value)[0])
    if isinstance(value, Times):
        return _text({"range": value[:2], "varies": value.varies})
    if isinstance(value, tuple):
        return f"[{', '.join(map(_text, value))}]"
    parts = _fields(value) if isinstance(value, SpecModel) else _parts(value, None)
    if parts is None:
        return str(value)
    return f"{{{', '.join(f'{key}: {_text(item)}' for key, item in parts.items())}}}"
