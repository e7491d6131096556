import re
from pathlib import Path

import pytest

from nrs_design.spec import RobotSpec, load_spec, parse_spec
from nrs_design.spec.load import read_axes
from nrs_design.spec.templates import TEMPLATES
from tests.support import spec_in

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.parametrize("name", TEMPLATES)
def test_templates_load_and_point_to_their_schema(name: str, tmp_path: Path) -> None:
    text = TEMPLATES[name]
    assert text.splitlines()[0] == "# yaml-language-server: $schema=./nrs.schema.json"
    path = spec_in(tmp_path, text, "template")
    for axis in read_axes(path):
        assert isinstance(axis.spec, RobotSpec) or axis.spec.switching.is_arbitrary
    assert text.isascii()
    assert max(map(len, text.splitlines())) <= 105


def test_robot_template_is_the_shipped_robot() -> None:
    shipped = load_spec(ROOT / "specs" / "robots" / "neuroboscope.nrs.yaml")
    template = parse_spec(TEMPLATES["robot"])
    assert template.model_copy(update={"name": shipped.name}) == shipped


def uncommented(name: str) -> str:
    """Text of a template with the rules that it shows in comments instead of `arbitrary`."""
    lines = [line for line in TEMPLATES[name].splitlines() if not line.startswith("switching:")]
    rules = "^# (?=  |parameters:$|goals:$|switching:$|resets:$)"
    shown = [re.sub(rules, "", line) for line in lines]
    # A dwell time goes with neither ranges nor several contacts.
    return "\n".join(line for line in shown if "dwell_time:" not in line)


def test_parameters_rules_and_resets_of_the_template_are_right() -> None:
    spec = parse_spec(uncommented("switched-system"))
    assert {name: p.varies for name, p in spec.parameters.items()} == {"k": True, "m": False}
    assert [mode.parameters for mode in spec.modes] == [set(), set(), {"k", "m"}]
    assert spec.switching.transitions == (("a", "b"), ("b", "a"), ("b", "c"), ("c", "a"))
    assert [(reset.source, reset.target) for reset in spec.resets] == [("a", "b")]
