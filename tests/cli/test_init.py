"""`nrs-design init`, as a user types it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest


def run(*arguments: str | Path, cwd: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "nrs_design", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, cwd=cwd, check=False)


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
