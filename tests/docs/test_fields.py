from pathlib import Path

import pytest
from making.examples import examples_of
from making.faults import DocumentationError
from making.fields import spec_page
from making.tables import cell, type_of, unit_of

from nrs_design.spec.load import SPEC_KINDS, model_of
from nrs_design.spec.schema import json_schema
from tests.support import ROOT, SOFT_TISSUE

DEFINITIONS = json_schema()["definitions"]
ROOTS = {model_of(kind).__name__: kind for kind in SPEC_KINDS}


@pytest.fixture(scope="module")
def page() -> str:
    return spec_page([("soft.yaml", SOFT_TISSUE)])


def test_every_field_has_a_row(page: str) -> None:
    rows = [line for line in page.splitlines() if line.startswith("| `")]
    assert len(rows) == sum(len(one.get("properties", {})) for one in DEFINITIONS.values())
    assert all(line.count(" | ") == 5 for line in rows)


def test_a_row_has_type_unit_default_meaning_and_an_example(page: str) -> None:
    # That of a force controller, which is optional, and that of the motion loop.
    _, row = (line for line in page.splitlines() if line.startswith("| `settling_time`"))
    assert row.split(" | ")[1:] == [
        DEFINITIONS["MotionLoopSpec"]["properties"]["settling_time"]["description"],
        "quantity",
        "`s`",
        "required",
        "[`0.1404 s`](soft.yaml) |",
    ]
    (digits,) = [line for line in page.splitlines() if line.startswith("| `significant_digits`")]
    assert "| `4` |" in digits
    # Examples that no spec has are those of the schema, or values that may be written.
    by_key = {line.split("`")[1]: line for line in page.splitlines() if line.startswith("| `")}
    assert by_key["load_inertia"].endswith("| `0.01 kg*m^2` |")
    assert by_key["admittance"].endswith("| `exact` |")


@pytest.mark.parametrize("silent", [("SensorSpec", "filter"), ("SensorSpec", None)])
def test_silence_stops_the_build(silent: tuple[str, str | None]) -> None:
    name, key = silent
    changed = {**DEFINITIONS, name: {**DEFINITIONS[name]}}
    if key is None:
        del changed[name]["description"]
    else:
        changed[name]["properties"] = {**changed[name]["properties"], key: {"type": "string"}}
    with pytest.raises(DocumentationError, match=f"{name}\\.{key}" if key else name):
        spec_page([], changed)


def test_examples_are_what_a_spec_says(tmp_path: Path) -> None:
    found = examples_of([("here", SOFT_TISSUE)], DEFINITIONS, ROOTS)
    assert found["LimitsSpec", "velocity"] == ("8 deg/s", "here")
    assert found["ElasticSpec", "lever_arm"].text == "0.24 m"
    # Alternatives are told by what selects them, and what is too long for a table is left out.
    assert ("KelvinVoigtSpec", "lever_arm") not in found
    assert ("InteractionDesignSpec", "controllers") not in found


def test_an_example_stands_in_the_spec_that_it_names() -> None:
    paths = sorted((ROOT / "specs").rglob("*.nrs.yaml"))
    found = examples_of([(str(path), path) for path in paths], DEFINITIONS, ROOTS)
    assert len(found) > 100
    for (_, key), example in found.items():
        text = Path(example.link).read_text(encoding="utf-8")
        assert f"{key}:" in text
        words = [word for word in example.text.strip("{}[]").split(", ") if ": " not in word]
        assert all(word.strip("{}[]") in text for word in words)


def test_types_and_units_in_words() -> None:
    assert type_of({"enum": ["a", "b"]}) == "`a`, `b`"
    assert type_of({"anyOf": [{"type": "string"}, {"type": "null"}]}) == "text or nothing"
    assert type_of({"type": "array", "items": {"$ref": "#/x/LegSpec"}}) == "list of [Leg](#legspec)"
    assert type_of({"type": "object", "patternProperties": {"a": {"type": "integer"}}}) == (
        "mapping of names to integer"
    )
    assert type_of({"type": "object"}) == "mapping"
    assert unit_of({"examples": ["4.84e-4 rad/s/rpm"]}) == "rad/s/rpm"
    assert unit_of({"anyOf": [{"type": "string"}, {"examples": ["1/3 m"]}]}) == "m"
    assert unit_of({"examples": ["yes or no"]}) == ""
    assert cell("a | b\nc ``d``") == "a \\| b c `d`"
