"""`check`, `schema` and `init`, as a user types them."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import jsonschema
import pytest

ROOT = Path(__file__).parents[2]
SOFT_TISSUE = ROOT / "specs/neuroboscope/soft-tissue.nrs.yaml"


def run(*arguments: str | Path, cwd: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "nrs_design", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, cwd=cwd, check=False)


def test_check_prints_values_as_written_and_in_si(tmp_path: Path) -> None:
    result = run("check", SOFT_TISSUE, cwd=tmp_path)
    assert result.returncode == 0
    line = next(line for line in result.stdout.splitlines() if "limits.velocity" in line)
    assert line.split()[1:] == ["8", "deg/s", "0.139626", "rad/s"]


def test_check_json_lists_the_lever_arm_conversion(tmp_path: Path) -> None:
    result = run("check", "--json", SOFT_TISSUE, cwd=tmp_path)
    document = json.loads(result.stdout)
    assert document["schema"] == "nrs-design/check/1"
    values = [(v["si"], v["unit"]) for v in document["specs"][0]["values"]]
    # Thesis 6.3.1.1: 747.1461 N/m at 0.24 m.
    assert ("43.0356", "N*m/rad") in [(si[:7], unit) for si, unit in values]


def test_check_goes_on_after_a_broken_spec(tmp_path: Path) -> None:
    broken = tmp_path / "broken.nrs.yaml"
    broken.write_text("kind: switched-system\nname: x\ntime: continuous\nmodes: []\n")
    result = run("check", "-q", broken, SOFT_TISSUE, cwd=tmp_path)
    assert result.returncode == 2
    assert "broken.nrs.yaml:" in result.stderr
    assert "NRS001" in result.stderr


@pytest.mark.parametrize("template", ["interaction-design", "hybrid-force", "switched-system"])
def test_a_fresh_spec_passes_check_and_is_proved(tmp_path: Path, template: str) -> None:
    assert run("init", template, "--out", "mine.nrs.yaml", cwd=tmp_path).returncode == 0
    first = (tmp_path / "mine.nrs.yaml").read_text().splitlines()[0]
    assert first.startswith("# yaml-language-server: $schema=")
    assert run("check", "-q", "mine.nrs.yaml", cwd=tmp_path).returncode == 0
    assert run("certify-switching", "-q", "mine.nrs.yaml", cwd=tmp_path).returncode == 0


def test_init_does_not_overwrite_unless_forced(tmp_path: Path) -> None:
    target = tmp_path / "switched-system.nrs.yaml"
    target.write_text("mine")
    assert run("init", "switched-system", cwd=tmp_path).returncode == 2
    assert target.read_text() == "mine"
    assert run("init", "switched-system", "--force", cwd=tmp_path).returncode == 0
    assert "kind: switched-system" in target.read_text()


def test_init_names_the_templates_when_one_is_unknown(tmp_path: Path) -> None:
    result = run("init", "interaction", cwd=tmp_path)
    assert result.returncode == 2
    assert "interaction-design" in result.stderr
    assert list(tmp_path.iterdir()) == []


def test_schema_is_draft_07(tmp_path: Path) -> None:
    assert run("schema", "--out", "nrs.schema.json", cwd=tmp_path).returncode == 0
    schema = json.loads((tmp_path / "nrs.schema.json").read_text())
    assert schema["$schema"] == "http://json-schema.org/draft-07/schema#"
    jsonschema.Draft7Validator.check_schema(schema)
