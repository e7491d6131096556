"""Every command of the tutorial runs, and prints what is shown."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support import ROOT
from tests.test_readme import squeeze

TUTORIAL = (ROOT / "docs" / "tutorial.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```console\n(.*?)^```", TUTORIAL, re.MULTILINE | re.DOTALL)
STEP = re.compile(r"^\$ (.*)\n((?:(?!\$ ).*\n)*)", re.MULTILINE)


@pytest.mark.slow
def test_the_tutorial(tmp_path: Path) -> None:
    program = tmp_path / "bin" / "nrs-design"
    program.parent.mkdir()
    program.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m nrs_design "$@"\n')
    program.chmod(0o755)
    folder = tmp_path / "robot"
    shutil.copytree(ROOT / "specs" / "data", folder / "data")
    environment = os.environ | {
        "PATH": f"{program.parent}:{os.environ['PATH']}",
        "PYTHONPATH": str(ROOT),
        "PYTHONWARNINGS": "default",
    }
    steps = [step for block in BLOCKS for step in STEP.findall(block)]
    assert len(steps) >= 10
    for command, shown in steps:
        result = subprocess.run(
            ["bash", "-c", command],
            capture_output=True,
            text=True,
            cwd=folder,
            check=False,
            env=environment,
        )
        assert squeeze(result.stdout) == squeeze(shown), (command, result.stderr)
        assert "error" not in result.stderr, (command, result.stderr)
    written = {path.name for path in folder.rglob("*") if "data" not in path.parts}
    assert {"arm.cert.json", "arm.html", "arm.json", "nrs.lock"} <= written
