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

from .samples import FORCE, IMPEDANCE, SWITCHED, refusal, spoiled

ROOT = Path(__file__).resolve().parents[2]
SHIPPED = sorted([*ROOT.glob("specs/**/*.nrs.yaml"), *ROOT.glob("docs/examples/*.nrs.yaml")])
RULES = """\
kind: switched-system
name: sample
time: continuous
parameters:
  k: {nominal: 43, range: [25, 90]}
  m: {nominal: 1, range: ["0.5", 2], varies: false}
modes:
  - {name: a, A: [[0, 1], [-2 - k, -1]]}
  - {name: b, A: [["1/6", 1], ["-(3/4*k - m/10.0 + 0.5)", -1e-3]]}
switching: {transitions: [[a, b], [b, a]]}
resets:
  - {from: a, to: b, map: [[1, 0], [0, "1/2"]]}
"""
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
    "text", [*TEMPLATES.values(), IMPEDANCE, FORCE, SWITCHED, RULES, DWELL, STEPS]
)
def test_templates_and_samples_validate(text: str, tmp_path: Path) -> None:
    assert faults(text) == []
    path = tmp_path / "sample.nrs.yaml"
    path.write_text(text, encoding="utf-8")
    assert read_axes(path)


@pytest.mark.parametrize(
    ("sample", "old", "new"),
    [
        (SWITCHED, "kind: switched-system\n", ""),
        (SWITCHED, "kind: switched-system", "kind: tissue"),
        (SWITCHED, "name: sample", "nane: sample"),
        (SWITCHED, "time: continuous", "time: never"),
        (SWITCHED, '"1/6"', '"1/0"'),
        (SWITCHED, '"1/6"', "true"),
        (SWITCHED, "[[-1, -1], [1, -1]]", "[]"),
        (SWITCHED, "switching: arbitrary\n", ""),
        (SWITCHED, "switching: arbitrary", "switching: never"),
        (SWITCHED, "switching: arbitrary", "switching: {}"),
        (SWITCHED, "switching: arbitrary", "switching: {dwell: 1 s}"),
        (SWITCHED, "switching: arbitrary", "switching: {dwell_time: 1}"),
        (SWITCHED, "switching: arbitrary", "switching: {transitions: [[a]]}"),
        (SWITCHED, "switching: arbitrary", "switching: {transitions: [[a, b, a]]}"),
        (RULES, "range: [25, 90]", "range: [25]"),
        (RULES, "nominal: 43", "nominal: 43 N"),
        (RULES, "nominal: 43, ", ""),
        (RULES, "varies: false", "varies: 1"),
        (RULES, "  k:", "  k-1:"),
        (RULES, "-2 - k", "k/0"),
        (RULES, "-2 - k", "k^2"),
        (RULES, "-2 - k", "k = 2"),
        (RULES, "from: a, ", ""),
        (RULES, "map: ", "matrix: "),
        (RULES, '"1/2"]]', "k]]"),
        (IMPEDANCE, "747.1461 N/m", "747.1461"),
        (IMPEDANCE, "747.1461 N/m", "{nominal: 1 N/m, range: [1 N/m]}"),
        (IMPEDANCE, "model: elastic", "model: rigid"),
        (IMPEDANCE, "Mt: 0.01", "mt: 0.01"),
        (IMPEDANCE, "0.3 N*m", "−0.3 N*m"),
        (IMPEDANCE, "Bt: {min: 0.1 N*m*s/rad, ", "Bt: {"),
        (
            IMPEDANCE,
            "Mt: 0.01",
            "desired_impedance: 1 N*m*s/rad\n    desired_impedance_ratio: 0.5\n    Mt: 0.01",
        ),
        (FORCE, "(N*m)\n", "(N*m)\n    damping_ratio: 0.741\n"),
        (FORCE, "    proportional_gain: 0.02 rad/(N*m)\n", ""),
        (FORCE, "{type: position}", "{type: impedance}"),
    ],
)
def test_schema_and_loader_refuse_the_same(sample: str, old: str, new: str) -> None:
    text = spoiled(sample, old, new)
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
    assert {
        "velocity",
        "Mt",
        "A",
        "range",
        "min",
        "lever_arm",
        "dwell_time",
        "from",
        "varies",
    } <= described.keys()
    assert [n for n, inner in properties(definitions) if not inner.get("description")] == []


def test_quantities_name_their_unit() -> None:
    for name, inner in properties(json_schema()["definitions"]):
        if "N*m" in json.dumps(inner.get("examples", "")):
            assert "N*m" in inner["description"] or name in ("min", "max", "nominal")
