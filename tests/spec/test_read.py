"""What specs are read as: a table of values by their path, and of lines that describe them."""

from collections.abc import Mapping, Set
from fractions import Fraction
from pathlib import Path

import pytest
from jsonschema import Draft7Validator
from ruamel.yaml import YAML

from nrs_design.spec import Quantity, parse_spec
from nrs_design.spec.describe import describe
from nrs_design.spec.model import SpecModel
from nrs_design.spec.schema import json_schema
from nrs_design.spec.switching import DwellTime
from tests.tables import cases_of, edit_of, edited, spec_text


def value_at(spec, path):
    for part in path.split("."):
        if isinstance(spec, Mapping):
            spec = spec[part]
        elif isinstance(spec, tuple) and part.isdigit():
            spec = spec[int(part)]
        else:
            spec = getattr(spec, part)
        spec = spec() if callable(spec) else spec
    return spec


def plain(value):
    """Return a value as the table has it: parts by what they are, mappings by their keys."""
    match value:
        case Fraction():
            return value.numerator if value.denominator == 1 else str(value)
        case Quantity() | DwellTime():
            return value.text
        case Mapping():
            return list(value)
        case Set():
            return sorted(value)
        case tuple() | list():
            return [plain(item) for item in value]
        case SpecModel():
            return type(value).__name__
    return value


@pytest.mark.parametrize("case", cases_of(Path(__file__).with_name("read.yaml"), "base"))
def test_a_spec_is_read_as_its_row_says(case):
    text = edited(spec_text(case["base"]), edit_of(case))
    spec = parse_spec(text)
    for path, wanted in case.get("reads", {}).items():
        value = plain(value_at(spec, path))
        assert value == (pytest.approx(wanted) if isinstance(wanted, float) else wanted), path
    for path, words in case.get("says", {}).items():
        assert str(value_at(spec, path)) == words
    lines = {name: rest for name, *rest in describe(spec)}
    for name, wanted in case.get("describes", {}).items():
        assert lines[name] == wanted, name
    assert "name" not in lines
    assert (".command" in "".join(lines)) or "limits.command" not in lines
    if "valid" in case:
        data = YAML(typ="safe", pure=True).load(text)
        assert Draft7Validator(json_schema()).is_valid(data) is case["valid"]
