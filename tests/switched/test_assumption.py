"""Every assumption that a spec makes carries what a reader needs to test it."""

import pickle
from dataclasses import fields

import pytest

from nrs_design.pipeline import run_design
from nrs_design.spec import read_spec
from nrs_design.switched import assumption_kinds
from nrs_design.switched.assemble import assemble, assemble_matrices
from nrs_design.switched.assumption import Assumption, AssumptionKind, Standing
from tests.support import ROOT

SPECS = sorted([*(ROOT / "specs").rglob("*.nrs.yaml"), *(ROOT / "docs").rglob("*.nrs.yaml")])
KINDS = [kind for kind in vars(assumption_kinds).values() if isinstance(kind, AssumptionKind)]
DOOR = AssumptionKind("the door", "shut", "It is cold.", "look")


def assumed(path):
    """Return what a spec takes for granted; nothing for a robot, which has no modes."""
    loaded = read_spec(path)
    if loaded.spec.kind == "robot":
        return ()
    if loaded.spec.kind == "switched-system":
        return assemble_matrices(loaded.spec).assumptions
    made = run_design(loaded)
    return assemble(made.spec, made.plant, made.design, made.spec.coordinates).assumptions


def named(path):
    name = path.name.split(".")[0]
    return pytest.param(path, id=name, marks=[pytest.mark.slow] if name == "hands-on" else [])


@pytest.mark.parametrize("path", [named(path) for path in SPECS])
def test_every_assumption_of_a_spec_has_all_fields(path):
    for sentence in assumed(path):
        assert isinstance(sentence, Assumption), sentence
        assert sentence.kind in KINDS
        assert sentence.bound


def test_kinds_have_names_of_their_own_and_no_empty_field():
    assert len({kind.name for kind in KINDS}) == len(KINDS) > 30
    for kind in KINDS:
        assert all(getattr(kind, field.name) for field in fields(kind))


def test_an_assumption_is_its_sentence():
    said = DOOR.says("The door is shut.")
    assert said == "The door is shut."
    assert (said.kind, said.bound, said.kind.standing) == (DOOR, "shut", Standing.OPEN)
    assert DOOR.says("It is.", "at most ajar").bound == "at most ajar"


def test_a_copy_keeps_kind_and_bound():
    copy = pickle.loads(pickle.dumps(DOOR.says("The door is shut.", "at night")))
    assert (copy, copy.kind, copy.bound) == ("The door is shut.", DOOR, "at night")
