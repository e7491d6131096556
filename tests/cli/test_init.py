"""`nrs-design init`, as a user types it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from nrs_design.cli.init import named_after
from tests.support import run


@pytest.mark.parametrize("template", ["interaction-design", "hybrid-force", "switched-system"])
def test_a_fresh_spec_passes_check_and_is_proved(tmp_path: Path, template: str) -> None:
    run("init", template, "--out", "mine.nrs.yaml", cwd=tmp_path, code=0)
    first = (tmp_path / "mine.nrs.yaml").read_text().splitlines()[0]
    assert first.startswith("# yaml-language-server: $schema=")
    run("check", "-q", "mine.nrs.yaml", cwd=tmp_path, code=0)
    run("certify-switching", "-q", "mine.nrs.yaml", cwd=tmp_path, code=0)


def test_a_spec_is_named_after_its_file() -> None:
    template = "kind: robot\nname: my-robot     # name\n"
    assert named_after(Path("a/Left Arm.nrs.yaml"), template) == (
        "kind: robot\nname: left-arm     # name\n"
    )
    assert "name: very-long-name # name" in named_after(Path("very-long-name.yml"), template)
    assert named_after(Path("---.nrs.yaml"), template) == template


def test_the_schema_that_editors_look_for_is_there(tmp_path: Path) -> None:
    done = run("init", "robot", "--out", "specs/arm.nrs.yaml", cwd=tmp_path)
    first = (tmp_path / "specs/arm.nrs.yaml").read_text().splitlines()[0]
    schema = tmp_path / "specs" / first.partition("$schema=")[2]
    assert json.loads(schema.read_text())["$schema"].startswith("http://json-schema.org/")
    assert "nrs.schema.json written" in done.stderr
    schema.write_text("{}")
    done = run("init", "switched-system", "--out", "specs/b.nrs.yaml", cwd=tmp_path)
    assert "is that of another version" in done.stderr
    assert schema.read_text() == "{}"


@pytest.mark.parametrize("taken", ["velocity", "position", "torque"])
@pytest.mark.parametrize("axis", ["", "prismatic"])
def test_a_robot_without_a_motor_has_a_template_of_its_own(
    taken: str, axis: str, tmp_path: Path
) -> None:
    asked = "--drive", taken, *(("--axis", axis) if axis else ()), "--out", "mine.nrs.yaml"
    if (taken, axis) == ("torque", "prismatic"):
        assert axis in run("init", "interaction-design", *asked, cwd=tmp_path, code=2).stderr
        return
    run("init", "interaction-design", *asked, cwd=tmp_path)
    text = (tmp_path / "mine.nrs.yaml").read_text(encoding="utf-8")
    assert f"{taken}_interface:" in text
    assert "\nname: mine " in text
    assert ("\naxis: prismatic " in text) == bool(axis)
    result = run("gate", "mine.nrs.yaml", "--no-reports", cwd=tmp_path, code=0)
    assert "all fulfilled" in result.stdout
    assert "warning" not in result.stderr
    refused = run("init", "robot", "--drive", taken, cwd=tmp_path, code=2)
    assert "interaction-design" in refused.stderr
