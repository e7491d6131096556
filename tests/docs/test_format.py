"""The page about the format, with that of each kind, names every field that a file may have."""

import re
from dataclasses import fields, is_dataclass
from typing import get_args, get_type_hints

import pytest

from nrs_design.certificates.certificate import SCHEMA
from nrs_design.proof.evidence import KINDS, class_of
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.system import SwitchedSystem
from tests.certificates.attacks import SHIPPED, shipped
from tests.docs.pages import kind_pages, text_of

PAGE = text_of("docs/certificates/format.md")
PAGES = kind_pages()


def named(*kinds):
    """Words within code, such as those of ``{name, unit, bound, columns}``."""
    text = "\n".join([PAGE, *(text_of(PAGES[kind]) for kind in kinds)])
    text = re.sub(r"^```.*?^```", "", text, flags=re.DOTALL | re.MULTILINE)
    return {word for code in re.findall(r"`([^`]+)`", text) for word in re.findall(r"\w+", code)}


def names(kind):
    """Yield the fields of a class, and of those within."""
    if is_dataclass(kind) or (isinstance(kind, type) and issubclass(kind, tuple)):
        hints = get_type_hints(kind)  # Those of a named tuple are its fields
        own = [field.name for field in fields(kind)] if is_dataclass(kind) else [*hints]
        for name in own:
            if hints[name] is not RationalMatrix:
                yield name
            yield from names(hints[name])
    for part in get_args(kind):
        yield from names(part)


def test_every_field_of_a_system_is_there():
    there = named("saturated-ellipsoid")
    assert set(names(SwitchedSystem)) - there == set()
    assert {"numerators", "denominator", SCHEMA.rpartition("/")[0].split("/")[1]} <= named()
    assert f"`{SCHEMA}`" in PAGE


@pytest.mark.parametrize("kind", KINDS)
def test_every_field_of_a_statement_is_there(kind):
    assert set(names(class_of(kind))) - named(kind) == set()


def test_every_field_that_ships_is_there():
    def keys(value):
        if isinstance(value, dict):
            for key, held in value.items():
                yield key
                # Names of controllers and of gains are those of the spec.
                yield from () if key == "gains" else keys(held)
        if isinstance(value, list):
            for item in value:
                yield from keys(item)

    found = {key for path in SHIPPED for key in keys(shipped(path.name.removesuffix(".cert.json")))}
    assert found - named(*KINDS) == set()
