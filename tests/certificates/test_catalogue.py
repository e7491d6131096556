"""Every assumption that a spec makes is a row of the table, and none gets lost."""

import ast
import re
import string
from dataclasses import fields

import pytest

from nrs_design.certificates.catalogue import (
    Standing,
    bound_of,
    catalogue_kind,
    keyed_texts,
    kinds,
    omitted,
    sentence,
    sentence_with_bound,
)
from nrs_design.controllers.laws import LAWS
from nrs_design.loop.assemble import assemble, assemble_matrices
from nrs_design.pipeline.runs import run_design
from nrs_design.proof.assumption import Assumption
from nrs_design.spec import read_spec
from nrs_design.spec.environment import ENVIRONMENT_LAWS
from nrs_design.spec.load import axes_at
from nrs_design.spec.provenance import COVERS, MOTOR_COVERS
from tests.support import ROOT
from tests.tables import rows

SPECS = [
    axis
    for folder in ("docs", "specs")
    for path in sorted((ROOT / folder).rglob("*.nrs.yaml"))
    for axis in axes_at(path)
]


def assumed(path):
    """Return what a spec takes for granted; nothing for a robot, which has no modes."""
    loaded = read_spec(path)
    if loaded.spec.kind == "robot":
        return ()
    if loaded.spec.kind == "switched-system":
        return assemble_matrices(loaded.spec).assumptions
    made = run_design(loaded)
    return assemble(made.spec, made.plant, made.design).assumptions


def named(path):
    name = path.name.replace(".nrs.yaml", "")
    return pytest.param(path, id=name, marks=[pytest.mark.slow] if name == "hands-on" else [])


@pytest.mark.parametrize("path", [named(path) for path in SPECS])
def test_a_spec_takes_for_granted_what_the_table_says(path):
    for assumption in assumed(path):
        assert sentence(assumption).endswith(".")
        assert bound_of(assumption)


def test_kinds_have_names_of_their_own_and_no_empty_field():
    rows = kinds().values()
    assert len({kind.name for kind in rows}) == len(rows) > 30
    for kind in rows:
        needed = {field.name for field in fields(kind)} - {*("about", "argued", "omits", "bounds")}
        assert all(getattr(kind, name) for name in needed), kind.id


def test_what_is_not_modelled_is_said_once_and_in_a_few_words():
    quiet = Assumption("uncoupled.axes")
    assert omitted([quiet, quiet, Assumption("not-sampled.continuous")]) == (
        "other axes",
        "sampling, delay, quantization, friction, saturation",
    )


def ids_in(text):
    """Yield patterns of the texts of a module: fields of an f-string may be any part of an id."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield re.escape(node.value)
        elif isinstance(node, ast.JoinedStr):
            parts = (
                re.escape(part.value) if isinstance(part, ast.Constant) else r"[\w-]*"
                for part in node.values
            )
            yield "".join(parts)


def test_every_sentence_of_the_catalogue_is_said_somewhere():
    """A name that no code has is of a sentence that nobody says any more."""
    files = (ROOT / "nrs_design").rglob("*.py")
    begins = tuple(re.escape(kind) for kind in kinds())
    found = {text for file in files for text in ids_in(file.read_text(encoding="utf-8"))}
    said = [pattern for pattern in found if pattern.startswith(begins)]
    ids = {f"{kind.id}.{name}" for kind in kinds().values() for name in kind.sentences}
    assert {id for id in ids if not any(re.fullmatch(pattern, id) for pattern in said)} == set()


def test_bounds_and_words_are_of_fields_of_sentences():
    said = {
        field
        for kind in kinds().values()
        for s in kind.sentences.values()
        for field in fields_in(s)
    }
    assert set(keyed_texts()) <= said
    for kind in kinds().values():
        assert set(kind.bounds) <= {*kind.sentences}, kind.id
        for text in kind.sentences.values():
            assert text.endswith((".", "}")), text
            assert "" not in fields_in(text)


def fields_in(text):
    return {field for _, field, _, _ in string.Formatter().parse(text) if field is not None}


def test_an_assumption_has_its_words_in_the_catalogue():
    axes = Assumption("uncoupled.axes")
    assert sentence(axes) == "The axes of the robot do not act on each other."
    assert (bound_of(axes), catalogue_kind(axes).standing) == ("zero coupling", Standing.OPEN)
    load = Assumption.create("load.sampled", inertia="2 kg*m^2", but="constant")
    assert "against an inertia of 2 kg*m^2. " in sentence(load)
    assert "within a period too, but for what is constant." in sentence(load)
    assert bound_of(load) == "2 kg*m^2"


@pytest.mark.parametrize(
    ("id", "given"), rows(__file__, "test_what_a_strangers_certificate_says_is_shown_as_it_is")
)
def test_what_a_strangers_certificate_says_is_shown_as_it_is(id, given):
    """Of this version, an id that the catalogue lacks is a defect."""
    given = {key: tuple(said) if isinstance(said, list) else said for key, said in given.items()}
    unknown = Assumption.create(id, **given)
    with pytest.raises((LookupError, ValueError)):
        sentence(unknown)
    said = sentence_with_bound(unknown)
    assert said.startswith(f"{unknown.id} (")
    assert "legs: a, b" in said
    assert "this version does not know" in said


def test_sentences_of_laws_are_about_one_law_each():
    laws = {*LAWS.values(), *ENVIRONMENT_LAWS}
    ids = [id for law in laws for id in law.sentences if id in vars(law)["sentences"]]
    assert len({*ids}) == len(ids)
    shared = {f"{kind.id}.{name}" for kind in kinds().values() for name in kind.sentences}
    assert not shared & {*ids}


def test_coverage_is_called_in_certificates_as_in_specs():
    said = keyed_texts()["covered"]
    assert said == {**COVERS, **{f"motor-{key}": text for key, text in MOTOR_COVERS.items()}}


def test_what_disturbances_bound_is_not_said_to_be_left_out():
    said = {"quantized": "sensors", "saturation": "left-out"}
    plain = Assumption.create("not-quantized.sampled", **said)
    disturbed = Assumption.create("not-quantized.sampled", **said, beyond="disturbances")
    assert omitted([plain]) == ("quantization, friction, saturation",)
    (text,) = omitted([disturbed])
    assert text == "quantization, friction beyond what disturbances bound, saturation"
