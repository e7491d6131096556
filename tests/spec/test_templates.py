from pathlib import Path

import pytest

from nrs_design.spec import RobotSpec, load_spec, parse_spec
from nrs_design.spec.interaction import InteractionDesignSpec
from nrs_design.spec.templates import TEMPLATES

ROOT = Path(__file__).resolve().parents[2]


def test_names() -> None:
    assert set(TEMPLATES) == {"interaction-design", "hybrid-force", "switched-system", "robot"}


@pytest.mark.parametrize("name", TEMPLATES)
def test_templates_load_and_point_to_their_schema(name: str) -> None:
    text = TEMPLATES[name]
    assert text.splitlines()[0] == "# yaml-language-server: $schema=./nrs.schema.json"
    assert getattr(parse_spec(text), "switching", "arbitrary") == "arbitrary"
    assert text.isascii()
    assert max(map(len, text.splitlines())) <= 105


@pytest.mark.parametrize("name", TEMPLATES)
def test_every_key_is_explained(name: str) -> None:
    # A key has a comment beside it, or stands in a block that is introduced by one.
    lines = TEMPLATES[name].splitlines()
    for number, line in enumerate(lines):
        if line and not line.startswith((" ", "#")):
            assert "#" in line or lines[number - 1].startswith("#"), line


def test_robot_template_is_the_shipped_robot() -> None:
    shipped = load_spec(ROOT / "specs" / "robots" / "neuroboscope.nrs.yaml")
    template = parse_spec(TEMPLATES["robot"])
    assert isinstance(template, RobotSpec)
    assert template.model_copy(update={"name": shipped.name}) == shipped


def test_hybrid_template_has_both_modes() -> None:
    spec = parse_spec(TEMPLATES["hybrid-force"])
    assert isinstance(spec, InteractionDesignSpec)
    assert {controller.type for controller in spec.controllers.values()} == {"position", "force"}
