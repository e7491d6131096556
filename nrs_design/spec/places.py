"""Turns the reports of validation into faults with place and remedy."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, get_args, get_origin

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from nrs_design.errors import Fault
from nrs_design.proof.text import quoted
from nrs_design.spec.document import Node, Position, steps_to
from nrs_design.spec.faults import FAULT, Location, did_you_mean, nearest
from nrs_design.spec.model import ParsedBy

# Below a choice between models, validation inserts the tag of the chosen one.
_CHOICES = {"environments": "model", "controllers": "type"}
# Other names of these keys.
_OTHER_NAMES = {
    "admittance": "impedance",
    "spring": "elastic",
    "voigt": "kelvin-voigt",
    "standard-linear-solid": "kelvin-boltzmann",
}
# Synonyms of keys, in small letters, which similar letters do not reveal.
_OTHER_KEYS = {
    key: frozenset(words.split())
    for key, words in {
        "period": "sample_time sampling_time ts dt rate frequency",
        "delay": "lag age",
        "time_constant": "tau t",
        "stiffness": "k spring elasticity",
        "damping": "d viscosity",
        "lever_arm": "arm lever length",
        "damping_ratio": "zeta damping",
        "settling_time": "ts settling",
        "derivative_gain": "kd derivative",
        "velocity": "speed max_velocity largest_velocity",
        "torque": "force moment max_torque largest_torque",
        "load_inertia": "inertia load",
        "gain": "k factor",
    }.items()
}
# Keys that `identify` writes into a section: listed after the keys that people write.
_IDENTIFIED = ("provenance", "doubts", "accept_doubt", "range_covers", "range_id", "intervals")
# Depth of that tag: below a name.
_DEPTH = 2
_MAPPINGS = ("model_type", "model_attributes_type", "dict_type")


def file_faults(error: ValidationError, model: type[BaseModel], root: Node) -> tuple[Fault, ...]:
    """Return the reports of validation as faults of the file, each once, in order of place."""
    resolved = {
        _resolve(details | {"ctx": context}, model, root)
        for details in _genuine(error)
        for context in details.get("ctx", {}).get("all", [details.get("ctx", {})])
    }
    each = sorted(resolved)
    return tuple(Fault(message, line, column, remedy) for line, column, message, remedy in each)


def _genuine(error: ValidationError) -> list[ErrorDetails]:
    """Leave out what only follows from another fault."""
    faults = error.errors(include_url=False)
    containers = {f["loc"][:depth] for f in faults for depth in range(len(f["loc"]))}
    mistyped: dict[Location, list[str]] = {}
    for f in faults:
        if f["type"] == "extra_forbidden":
            mistyped.setdefault(f["loc"][:-1], []).append(str(f["loc"][-1]))
    return [
        f
        for f in faults
        if not (
            f["type"] == "default_factory_not_called"
            # A list with wrong items counts as too short.
            or (f["type"] in ("too_short", "too_long") and f["loc"] in containers)
            or (f["type"] == "missing" and _is_mistyped(f["loc"], mistyped))
        )
    ]


def _is_mistyped(location: Location, mistyped: dict[Location, list[str]]) -> bool:
    """Whether a missing key is there under a similar name, which is reported itself."""
    siblings, name = mistyped.get(location[:-1], []), str(location[-1])
    called = any(sibling.lower() in _OTHER_KEYS.get(name, ()) for sibling in siblings)
    return called or bool(difflib.get_close_matches(name, siblings, n=1))


def _of_keys(word: str, fields: Mapping[str, FieldInfo | None]) -> str:
    """Suggest the intended key, by a synonym or one level deeper; list the keys."""
    keys = sorted(fields, key=_IDENTIFIED.__contains__)
    called = [key for key in keys if word.lower() in _OTHER_KEYS.get(key, ())]
    listing = did_you_mean(word, keys, "keys here are", called)
    parts = {key: (field.annotation, *field.metadata) for key, field in fields.items() if field}
    inside = [key for key, part in parts.items() if word in _keys_below(*part)]
    if not inside or nearest(word, keys, called):
        return listing
    places = f"{' or '.join(inside)}, as in `{inside[0]}: {{{word}: ...}}`"
    return f"it belongs inside {places}; {listing}"


def _keys_below(*parts: Any) -> Iterator[str]:
    """Yield the keys of every form in which a field may be written."""
    for part in parts:
        if isinstance(part, ParsedBy):
            for form in (part.schema or {}).get("anyOf", ()):
                yield from form.get("properties", ())
        elif get_origin(part) not in (dict, tuple):
            yield from (*getattr(part, "model_fields", ()), *_keys_below(*get_args(part)))


def _resolve(
    details: ErrorDetails, model: type[BaseModel], root: Node
) -> tuple[int, int, str, str]:
    kind, context = details["type"], details.get("ctx", {})
    location = _without_tag(details["loc"])
    at_key = kind == "extra_forbidden" or (bool(location) and location[-1] == "[key]")
    location += tuple(context.get("at", ()))
    tag = (_CHOICES[str(location[0])],) if kind == "union_tag_invalid" else ()
    place = place_of(root, (*(p for p in location if p != "[key]"), *tag), at_key)
    return place.line, place.column, *_words(details, location, model)


def _without_tag(location: Location) -> Location:
    chosen = len(location) > _DEPTH and location[0] in _CHOICES and location[_DEPTH] != "[key]"
    return location[:_DEPTH] + location[_DEPTH + 1 :] if chosen else location


def place_of(root: Node, location: Location, at_key: bool) -> Position:
    """Return the position of the node, or of its nearest parent in the file.

    `at_key`: that of the key, not of its value.
    """
    steps = [*steps_to(root, location)]
    key, node = steps[-1] if steps else (root.position, root)
    # A block mapping or list starts below its key: the key shows it best.
    below = node.position.line > key.line
    return key if below or (at_key and len(steps) == len(location)) else node.position


def _words(details: ErrorDetails, location: Location, model: type[BaseModel]) -> tuple[str, str]:
    kind, context = details["type"], details.get("ctx", {})
    where = dotted(location)
    if kind == FAULT:
        return f"{where}: {context['message']}" if where else context["message"], context["remedy"]
    if kind == "missing":
        name = str(location[-1])
        field = _fields_at(model, details["loc"][:-1]).get(name)
        return f"`{where}` is missing", f"add {name}: {field.description if field else ''}"
    if kind == "extra_forbidden":
        fields, key = _fields_at(model, details["loc"][:-1]), str(location[-1])
        return f"unknown key `{where}`", _of_keys(key, fields)
    if kind in ("union_tag_not_found", "union_tag_invalid"):
        return _tag_words(where, _CHOICES[str(location[0])], details)
    value, where = details["input"], where or "the file"
    if kind == "literal_error":
        if not isinstance(value, str):
            return f"{where}: expected a single value, not {_shape(value)}", "write one value"
        remedy = f"write {context['expected']}"
        return f"{where}: {quoted(value)} is not known", remedy
    if kind in _MAPPINGS:
        keys = ["name"]
        if kind != "dict_type":
            keys = [*_fields_at(model, details["loc"], needed=True)]
        listing = ", ".join(f"{key}: ..." for key in keys)
        return (
            f"{where}: expected a mapping, not {_shape(value)}",
            f"write {location[-1] if location else 'the file'}: {{{listing}}}",
        )
    if kind == "tuple_type":
        return f"{where}: expected a list, not {_shape(value)}", "write [..., ...]"
    if kind == "too_short":
        return f"{where}: must not be empty", "add at least one entry"
    if kind == "too_long":
        return f"{where}: more than {context['max_length']} entries are not read", "remove some"
    # The message of the type itself.
    message = str(context["error"]) if kind == "value_error" else details["msg"]
    return f"{where}: {message}", "see `nrs-design schema` for what belongs here"


def _shape(value: object) -> str:
    """Name what was found, in the words of the file."""
    if isinstance(value, dict):
        return "a mapping"
    return "a list" if isinstance(value, tuple | list) else quoted(str(value))


def _tag_words(where: str, key: str, details: ErrorDetails) -> tuple[str, str]:
    context = details["ctx"]
    if "tag" not in context:
        written = details["input"]
        other = next((k for k in sorted({*_CHOICES.values(), "kind"}) if k in written), None)
        return f"`{where}.{key}` is missing", f"write {key} for {other}" if other else f"add {key}"
    expected = [tag.strip(" '") for tag in context["expected_tags"].split(",")]
    tag = details["input"][key]
    if not isinstance(tag, str):
        remedy = f"write one of {', '.join(expected)}"
        return f"{where}.{key}: expected a single value, not {_shape(tag)}", remedy
    if (usual := _OTHER_NAMES.get(tag)) in expected:
        return f"{where}.{key}: {quoted(tag)} is not known", f"write {usual}: it is called so here"
    return f"{where}.{key}: {quoted(tag)} is not known", did_you_mean(tag, expected)


def dotted(location: Iterable[int | str]) -> str:
    """Write a location as in ``modes[0].A[1][0]``."""
    text = ""
    for part in location:
        if part != "[key]":
            text += f"[{part}]" if isinstance(part, int) else f".{part}"
    return text.removeprefix(".")


def _fields_at(
    model: type[BaseModel], location: Location, *, needed: bool = False
) -> dict[str, FieldInfo | None]:
    """Keys and fields at a location as validation reports it, tags included.

    `needed`: only those that must be there; all, if none must.
    """
    if not location:
        fields = list(model.model_fields.items())
        if needed:
            fields = [item for item in fields if item[1].is_required()] or fields
        return {field.alias or name: field for name, field in fields}
    field = model.model_fields.get(str(location[0]))
    arms = _models_in(field.annotation) if field else []
    rest = location[1:]
    if location[0] in _CHOICES:
        key = _CHOICES[str(location[0])]
        if len(rest) < _DEPTH:
            return {key: None}
        tag = rest[_DEPTH - 1]
        arms = [arm for arm in arms if tag in get_args(arm.model_fields[key].annotation)]
        rest = rest[_DEPTH:]
    elif field and get_origin(field.annotation) is dict:
        rest = rest[1:]
    while rest and isinstance(rest[0], int):
        rest = rest[1:]
    return _fields_at(arms[0], rest, needed=needed) if arms else {}


def _models_in(annotation: Any) -> list[type[BaseModel]]:
    """Models anywhere within an annotation such as ``dict[str, A | B]``."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [found for argument in get_args(annotation) for found in _models_in(argument)]
