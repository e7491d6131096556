import json
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft7Validator
from ruamel.yaml import YAML

from nrs_design.spec import load_spec
from nrs_design.spec.load import axes_at, read_axes
from nrs_design.spec.schema import json_schema
from nrs_design.spec.templates import TEMPLATES
from tests.support import spec_in
from tests.tables import edited, spec_text, table

from .samples import FORCE, IMPEDANCE, SWITCHED, refusal, spoiled

ROOT = Path(__file__).resolve().parents[2]
SHIPPED = sorted([*ROOT.glob("specs/**/*.nrs.yaml"), *ROOT.glob("docs/examples/*.nrs.yaml")])
RULES = spec_text("rules")
SPRUNG = spoiled(IMPEDANCE, "    Bt:", "    Kt: 0.5 N*m/rad\n    Bt:")
DWELL = spoiled(SWITCHED, "switching: arbitrary", "switching: {dwell_time: 2.76 s}")
STEPS = SWITCHED.replace("continuous", "discrete").replace("arbitrary", "{dwell_time: 3 steps}")


@cache
def validator() -> Draft7Validator:
    return Draft7Validator(json_schema())


def faults(text: str) -> list[str]:
    data = YAML(typ="safe", pure=True).load(text)
    return [error.message for error in validator().iter_errors(data)]


def test_the_schema_is_draft_7() -> None:
    schema = json_schema()
    Draft7Validator.check_schema(schema)
    assert schema["$schema"] == "http://json-schema.org/draft-07/schema#"
    assert "$defs" not in json.dumps(schema)
    assert json_schema() == json.loads(json.dumps(schema))


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.name)
def test_shipped_specs_validate_and_are_named_as_their_files(path: Path) -> None:
    assert faults(path.read_text()) == []
    for axis in axes_at(path):
        file, _, name = axis.name.partition("#")
        said = file.removesuffix(".nrs.yaml") + f"-{name}" * bool(name)
        assert load_spec(axis).name == said


@pytest.mark.parametrize(
    "text", [*TEMPLATES.values(), IMPEDANCE, FORCE, SWITCHED, RULES, DWELL, STEPS, SPRUNG]
)
def test_templates_and_samples_validate(text: str, tmp_path: Path) -> None:
    assert faults(text) == []
    assert read_axes(spec_in(tmp_path, text, "sample"))


@pytest.mark.parametrize(
    ("base", "edit"),
    [
        (base, edit)
        for base, edits in table(Path(__file__).with_name("schema.yaml")).items()
        for edit in edits
    ],
)
def test_schema_and_loader_refuse_the_same(base: str, edit: list[str]) -> None:
    text = edited(spec_text(base), edit)
    assert faults(text)
    assert refusal(text)


def properties(schema: Any) -> Iterator[tuple[str, dict[str, Any]]]:
    if isinstance(schema, dict):
        for name, inner in schema.get("properties", {}).items():
            yield name, inner
        for inner in schema.values():
            yield from properties(inner)
    elif isinstance(schema, list):
        for inner in schema:
            yield from properties(inner)


def test_every_key_is_described() -> None:
    definitions = json_schema()["definitions"]
    described = dict(properties(definitions))
    known = ["velocity", "Mt", "A", "range", "min", "lever_arm", "dwell_time", "from", "varies"]
    assert {*known} <= described.keys()
    assert [n for n, inner in properties(definitions) if not inner.get("description")] == []
