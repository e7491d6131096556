"""What counts as weaker: a table of edits of one spec, and properties of the comparison."""

import json
import re
from pathlib import Path
from types import NoneType
from typing import get_args

import pytest
from pydantic import TypeAdapter, ValidationError

from nrs_design.spec.document import parse_document, to_data
from nrs_design.spec.interaction import InteractionDesignSpec
from nrs_design.spec.interaction_parts import AbstractInteractionSpec
from nrs_design.spec.load import read_axes
from nrs_design.spec.model import Declared, SpecModel, declared_in
from nrs_design.spec.parameters import ParameterSpec
from nrs_design.spec.preload import ExponentSpec
from nrs_design.spec.provenance import IdentifiedRangesSpec
from nrs_design.spec.quantity_fields import RangedQuantity
from nrs_design.spec.robot import RobotSpec
from nrs_design.spec.spec_weakening import find_changes
from nrs_design.spec.switched_system import SwitchedSystemSpec
from tests.support import ROOT
from tests.tables import cases_of, edit_of, edited, rows, spec_text


def spec_of(text):
    """Read the fields of a spec, without the checks between its parts."""
    model = AbstractInteractionSpec if "interaction-design" in text else SwitchedSystemSpec
    return model.model_validate(to_data(parse_document(text)))


def changes(before, after):
    return list(find_changes(spec_of(before), spec_of(after)))


WAYS = {(True, False): "there", (False, True): "back", (True, True): "both"}


@pytest.mark.parametrize("case", cases_of(Path(__file__).with_name("spec_weakening.yaml"), "base"))
def test_what_an_edit_makes_weaker(case):
    before = edited(spec_text(case["base"]), case.get("given", []))
    after = edited(before, edit_of(case))
    there, back = changes(before, after), changes(after, before)
    assert bool(there) is bool(back) is (case["weaker"] != "same")
    ways = tuple(any(change.weaker for change in way) for way in (there, back))
    assert WAYS.get(ways, "neither" if there else "same") == case["weaker"]


def test_a_part_more_is_weaker_where_it_takes_the_place_of_what_holds_unsaid():
    text = spec_text("weaker")
    logic = text[text.index("mode_logic:") : text.index("switching:")]
    before = text.replace(logic, "")
    after = edited(before, ["controllers:\n", "controllers:\n  first: {type: position}\n"])
    assert any(change.weaker for change in changes(before, after))


RANGED = {RangedQuantity, ExponentSpec, ParameterSpec}


def models_in(annotation):
    if isinstance(annotation, type) and issubclass(annotation, SpecModel):
        return {annotation}
    return {model for part in get_args(annotation) for model in models_in(part)}


def all_models():
    found, waiting = set(), [InteractionDesignSpec, SwitchedSystemSpec, RobotSpec]
    for model in waiting:
        below = {m for f in model.model_fields.values() for m in models_in(f.annotation)}
        waiting += sorted(below - found - {*waiting}, key=str)
        found |= below | {model}
    return sorted(found - RANGED, key=str)


MODELS = {model.__name__.removesuffix("Spec"): model for model in all_models()}
# Of these any other value is weaker, of the others one that is larger or smaller.
EITHER = (
    "Elastic KelvinVoigt Hand Maxwell HuntCrossley KelvinBoltzmann Monitoring "
    "TaskLimits Sinusoid Surface CommandCondition TorqueCondition ThresholdControl SignControl"
)
BORNE = "Disturbances Sensor Sampling Goals TorqueSignal CommandSignal Errors ScenarioLimits"
# Parts, which are compared by their own fields, and values that no two guesses fit.
PARTS = {"filter", "misses", "model"}
PARTS |= {"center_of_mass", "surface", "side", "parameters"}
WORDS = {*IdentifiedRangesSpec.model_fields, "linearized_about", "admittance"}


def values_of(model, key, *each):
    """Read a field once for each of some values."""
    field = TypeAdapter(model.model_fields[key].rebuild_annotation())
    return [model.model_construct(**{key: field.validate_python(value)}) for value in each]


def unit_in(schema):
    """Return the unit of the first example of a quantity, or nothing."""
    unit = re.search(r'"examples": \["\S+ ([^"]+)"', json.dumps(schema))
    return unit[1] if unit else ""


def two_values(model, key, schema):
    """Read a field twice, a larger value and a smaller one; nothing if it is no such field."""
    low, high = (f"{n} {unit_in(schema)}".strip() for n in ("1", "2"))
    for each in ((low, high), ((low, low), (low, high)), ("1.25", "1.5"), ("0.25", "0.5")):
        try:
            return values_of(model, key, *each)
        except ValidationError:
            continue
    return None


def is_weaker(before, after):
    return any(change.weaker for change in find_changes(before, after))


@pytest.mark.parametrize("name", f"{BORNE} {EITHER}".split())
def test_every_value_of_what_must_be_borne_is_weaker_in_a_direction(name):
    """By its value: a part that nobody has thought of here is not passed over."""
    model = MODELS[name]
    for key, schema in model.model_json_schema()["properties"].items():
        said = None if key in WORDS else two_values(model, key, schema)
        if said is None:
            assert key in WORDS or key in PARTS, key
            continue
        value = getattr(said[1], key)
        wider = isinstance(value, tuple) and name not in ("Sampling", "Surface")
        either = (name in EITHER.split() or isinstance(value, str)) and not wider
        limit = key.startswith("max_") or key == "peak_torque" or name == "ScenarioLimits"
        assert is_weaker(*said) is (limit or either), key
        assert is_weaker(*reversed(said)) is (either or not limit), key


@pytest.mark.parametrize(
    "name", ["Actuator", "VelocityInterface", "PositionInterface", "TorqueInterface"]
)
def test_a_narrower_range_of_a_drive_is_weaker_and_another_drive_is_not(name):
    model = MODELS[name]
    for key, field in model.model_fields.items():
        if RANGED & models_in(field.annotation):
            unit = unit_in(model.model_json_schema()["properties"][key])
            low, middle, high = (f"{n} {unit}" for n in (1, 2, 3))
            wide = {"nominal": middle, "range": (low, high)}
            said = values_of(model, key, wide, wide | {"range": (low, middle)}, low, high)
            assert [is_weaker(said[0], other) for other in said] == [False, True, True, True]
            assert [is_weaker(other, said[0]) for other in said] == [False] * 4
            assert not is_weaker(said[2], said[3])
    said = values_of(model, "dead_time", ("1 ms", "2 ms"), ("1 ms", "1.5 ms"), "1 ms", "3 ms")
    assert [is_weaker(said[0], other) for other in said] == [False, True, True, True]
    assert not is_weaker(said[3], said[2])


@pytest.mark.parametrize("name", rows(__file__, "test_what_a_controller_touches"))
def test_what_a_controller_touches(name):
    model = MODELS[name]
    assert is_weaker(*values_of(model, "environment", "soft", "hard"))
    both, one = values_of(model, "contacts", ("soft", "hard"), ("soft",))
    assert is_weaker(both, one)
    assert not is_weaker(one, both)


RANGES = {"wider", "farther", "holding"}


@pytest.mark.parametrize("model", all_models())
def test_every_field_says_which_of_two_values_asks_for_more(model):
    for name, field in model.model_fields.items():
        stronger, _ = declared_in(model)[field.alias or name]
        own = [mark.stronger for mark in field.metadata if isinstance(mark, Declared)]
        below = models_in(field.annotation)
        assert any(own) or model.declared.stronger or below, name
        # A range is more than its ends, and only words are in an order of their own.
        assert stronger in RANGES or not below & RANGED, name
        assert not isinstance(stronger, tuple) or {*stronger} == words_of(field.annotation), name


def words_of(annotation):
    parts = get_args(annotation)
    return {w for part in parts for w in words_of(part)} or {
        None if annotation is NoneType else annotation
    }


def test_every_part_that_a_shipped_spec_loses_is_weaker_or_beside_the_proof():
    """Whatever is not said any more is weaker, unless it was an assumption or words."""
    for path in sorted((ROOT / "specs").glob("*/*.nrs.yaml")):
        for loaded in read_axes(path):
            spec = loaded.spec
            for key in spec.model_fields_set - {"kind", "controllers", "switching"}:
                found = list(find_changes(spec, spec.model_copy(update={key: None})))
                beside = key in {"title", "mode_logic", "misses"}
                beside |= (key, getattr(spec, key)) == ("contact", "kept")
                assert any(change.weaker for change in found) is not beside, (path, key)
