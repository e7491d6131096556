"""Every assumption that a spec makes is a row of the table, and none gets lost."""

import pickle
import string
from dataclasses import fields

import pytest

from nrs_design.loop.assemble import assemble, assemble_matrices
from nrs_design.loop.assumption import Assumption, Standing, kinds, omitted, say
from nrs_design.pipeline.runs import run_design
from nrs_design.spec import read_spec
from nrs_design.spec.load import axes_at
from tests.support import ROOT

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
    for sentence in assumed(path):
        assert isinstance(sentence, Assumption), sentence
        assert sentence.kind.id == sentence.id.split(".")[0]
        assert sentence.bound


def test_kinds_have_names_of_their_own_and_no_empty_field():
    rows = kinds().values()
    assert len({kind.name for kind in rows}) == len(rows) > 30
    for kind in rows:
        needed = {field.name for field in fields(kind)} - {"field", "argued", "omits"}
        assert all(getattr(kind, name) for name in needed), kind.id


def test_what_is_not_modelled_is_said_once_and_in_a_few_words():
    quiet = say("uncoupled.axes")
    assert omitted([quiet, quiet, "a plain text", say("not-sampled.continuous")]) == (
        "other axes",
        "sampling, delay, quantization, friction, saturation",
    )


def test_every_sentence_of_the_table_is_said_somewhere():
    """A name that no code has is of a sentence that nobody says any more."""
    code = "".join(p.read_text(encoding="utf-8") for p in (ROOT / "nrs_design").rglob("*.py"))
    for kind in kinds().values():
        for name, sentence in kind.says:
            whole = f'"{kind.id}.{name}"' in code
            # The rest of the id is put together where it is said.
            assert whole or f'f"{kind.id}.{{' in code, f"{kind.id}.{name}"
            assert sentence.endswith((".", "}")), sentence
            assert all(field != "" for _, field, _, _ in string.Formatter().parse(sentence))


def test_an_assumption_is_its_sentence():
    said = say("uncoupled.axes")
    assert said == "The axes of the robot do not act on each other."
    assert (said.id, said.bound, said.kind.standing) == (
        "uncoupled.axes",
        "zero coupling",
        Standing.OPEN,
    )
    assert say("uncoupled.axes", "nearly zero").bound == "nearly zero"


def test_a_copy_keeps_id_and_bound():
    copy = pickle.loads(pickle.dumps(say("load.inertia", "at night", inertia=2)))
    assert (copy.id, copy.kind.id, copy.bound) == ("load.inertia", "load", "at night")
    assert "against an inertia of 2." in copy


def test_what_disturbances_bound_is_not_said_to_be_left_out():
    plain, disturbed = say("not-quantized.sampled"), say("not-quantized.sampled-disturbed")
    assert omitted([plain]) == ("quantization, friction, saturation",)
    (words,) = omitted([disturbed])
    assert words == "quantization, friction beyond what disturbances bound, saturation"
