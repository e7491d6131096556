"""What tables beside the tests of evidence say: a system, the numbers, and what is found of them.

A group or a case names an `example` of `systems.py`, or a `system` and `evidence`. A system is a
function of that file, in a list with its arguments, or fields with the `modes`; evidence is its
kind and its fields. A matrix stands as its rows, or as `rows` `over` a denominator, and what else
has fields as their list. `with` changes fields of the system, `but` fields of the evidence, by
their dotted paths. `says` has words of the fault, or null if there is none; of the misfit, if the
case `asks` for that. `holds` tells whether it is so by the definition, `fits` whether it covers the
switching, and `claim` or `claims` what it says, or words of it; `contradiction` is what is odd of a
system alone.
"""

from dataclasses import fields, is_dataclass, replace
from fractions import Fraction
from pathlib import Path
from types import NoneType, UnionType
from typing import Any, get_args, get_origin, get_type_hints

import pytest

from nrs_design.proof.contradiction import find_contradiction
from nrs_design.proof.evidence import AbstractEvidence, class_of
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from tests.proof import systems
from tests.proof.truth import holds
from tests.tables import table

CHANGES = ("with", "but")
ASKED = {"says", "holds", "fits", "claim", "claims", "contradiction"}
KNOWN = {"example", "system", "evidence", "cases", "asks", *CHANGES, *ASKED}


def cases(file: str) -> list[Any]:
    """Return the cases of the groups of a table; what both change is changed by both."""
    path = Path(file).with_suffix(".yaml")
    return [
        pytest.param(
            {**group, **case, **{key: group.get(key, {}) | case.get(key, {}) for key in CHANGES}},
            id=f"{first}-{number}",
        )
        for first, group in enumerate(table(path))
        for number, case in enumerate(group["cases"])
    ]


def check(case: dict[str, Any]) -> None:
    # A word that nobody reads would ask for nothing, and no words are in every fault.
    assert case.keys() <= KNOWN
    assert case.keys() & ASKED
    assert "asks" not in case or "says" in case
    claims = case.get("claims", [])
    assert isinstance(claims, list)
    assert "" not in (case.get("says"), case.get("contradiction"), *claims)
    system = system_in(case)
    if "contradiction" in case:
        assert case.keys() & ASKED == {"contradiction"}
        found, words = find_contradiction(system), case["contradiction"]
        assert (found is None) is (words is None), found
        assert found is None or words in found, found
        return
    evidence = evidence_in(case)
    if "says" in case:
        found = getattr(evidence, f"find_{case.get('asks', 'fault')}")(system)
        assert (found is None) is (case["says"] is None), found
        assert found is None or case["says"] in found, found
    if "holds" in case:
        assert holds(system, evidence) is case["holds"]
    if "fits" in case:
        assert evidence.fits(system.switching) is case["fits"]
    if "claim" in case:
        assert evidence.claim(system) == case["claim"]
    for words in claims:
        assert words in evidence.claim(system)


def system_in(case: dict[str, Any]) -> SwitchedSystem:
    said = case.get("system")
    if said is None:
        system, _ = systems.genuine(case["example"])
    elif isinstance(said, dict):
        matrices = said["modes"]
        other = {key: value for key, value in said.items() if key != "modes"}
        system = _changed(SwitchedSystem, systems.family(*matrices), other)
    else:
        system = systems.built(said)
    return _changed(SwitchedSystem, system, case["with"])


def evidence_in(case: dict[str, Any]) -> AbstractEvidence:
    said = case.get("evidence")
    evidence = systems.genuine(case["example"])[1] if said is None else made(AbstractEvidence, said)
    return _changed(type(evidence), evidence, case["but"])


def made(hint: Any, value: Any) -> Any:
    """Return what a table says as a value of a type; what is of another type is left as it is."""
    if value is not None:
        hint = _inner(hint)
    if hint is Fraction and isinstance(value, (int, str)):
        return Fraction(value)
    if hint is AbstractEvidence:
        named = dict(value)
        kind = class_of(named.pop("kind"))
        return kind(**{name: made(part, named[name]) for name, part in _parts(kind, named)})
    if hint is RationalMatrix:
        if not isinstance(value, dict):
            return systems.matrix(value)
        assert value.keys() == {"rows", "over"}
        return RationalMatrix(tuple(map(tuple, value["rows"])), value["over"])
    if hint is Time:
        return Time(value)
    if get_origin(hint) is tuple and isinstance(value, list):
        first, *others = get_args(hint)
        hints = [first] * len(value) if others == [...] else [first, *others]
        return tuple(made(part, item) for part, item in zip(hints, value, strict=True))
    if _has_fields(hint) and isinstance(value, (list, dict)):
        # Of a list, the last fields may be left out.
        names = _names(hint)[: len(value)]
        named = value if isinstance(value, dict) else dict(zip(names, value, strict=True))
        return hint(**{name: made(part, named[name]) for name, part in _parts(hint, named)})
    return value


def _changed(hint: Any, thing: Any, changes: dict[str, Any]) -> Any:
    for path, value in changes.items():
        thing = _put(hint, thing, path, value)
    return thing


def _put(hint: Any, thing: Any, path: str, value: Any) -> Any:
    """Return a thing of which what a path leads to is another."""
    if not path:
        return made(hint, value)
    hint = _inner(hint)
    name, _, rest = path.partition(".")
    if type(thing) is tuple:
        k = int(name) % len(thing)
        inner = get_args(hint)[0 if get_args(hint)[-1] is ... else k]
        return (*thing[:k], _put(inner, thing[k], rest, value), *thing[k + 1 :])
    changed = {name: _put(get_type_hints(type(thing))[name], getattr(thing, name), rest, value)}
    return thing._replace(**changed) if isinstance(thing, tuple) else replace(thing, **changed)


def _inner(hint: Any) -> Any:
    """Return the type of what is not None, if a type is optional; else the type itself."""
    if get_origin(hint) is not UnionType:
        return hint
    (inner,) = (part for part in get_args(hint) if part is not NoneType)
    return inner


def _has_fields(hint: Any) -> bool:
    named = isinstance(hint, type) and hint is not tuple and issubclass(hint, tuple)
    return named or is_dataclass(hint)


def _names(hint: Any) -> tuple[str, ...]:
    if is_dataclass(hint):
        return tuple(field.name for field in fields(hint))
    return tuple(get_type_hints(hint))


def _parts(hint: Any, named: dict[str, Any]) -> list[tuple[str, Any]]:
    return [(name, get_type_hints(hint)[name]) for name in named]
