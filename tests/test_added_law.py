"""A control law is added to a copy of the package: two files, for all that is done with a law."""

import filecmp
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.exporters.programs import STRICT, compiler
from tests.package import PACKAGE
from tests.simulation.interactions import text_of

ADDITIONS = Path(__file__).parent / "additions"
LAG = "{type: lag-force, environment: soft, gain: 0.01 rad/(N*m), lag: 50 ms}"
SAMPLED = "sampling: {period: 2 ms, delay: [0, 1]}\ncontact: kept\n"
MAIN = """#include "sampled_test.h"
int main(void) { return (int)nrs_sampled_self_test() + 1; }
"""
COMMANDS = (
    ("certify-switching", "continuous.nrs.yaml"),
    ("verify", "reports/continuous.cert.json", "continuous.nrs.yaml"),
    ("certify-switching", "sampled.nrs.yaml"),
    ("verify", "reports/sampled.cert.json", "sampled.nrs.yaml"),
    ("simulate", "sampled.nrs.yaml", "--engine", "sampled"),
    ("simulate", "continuous.nrs.yaml", "--engine", "exact"),
    ("export", "sampled.nrs.yaml", "--format", "c"),
    ("export", "sampled.nrs.yaml", "--format", "vectors"),
)


def add_law(package: Path) -> None:
    """Add the law of `tests.additions.lag_force`: its file, and what a spec says of it."""
    shutil.copy(ADDITIONS / "lag_force.py", package / "controllers" / "laws")
    spec = package / "spec" / "controllers.py"
    text = spec.read_text(encoding="utf-8")
    table, last = "ControllerSpec = Annotated[", "    | PositionControllerSpec,"
    assert table in text
    assert last in text
    model = (ADDITIONS / "lag_force_spec.txt").read_text(encoding="utf-8")
    text = text.replace(table, f"{model}{table}")
    text = text.replace(last, f"    | LagForceControllerSpec\n{last}")
    spec.write_text(text, encoding="utf-8")


def changed(old: Path, new: Path) -> int:
    """Count the files that one folder has not, or otherwise, than another."""
    found = filecmp.dircmp(old, new, ignore=["__pycache__"])
    own = len(found.right_only) + len(found.diff_files)
    return own + sum(changed(old / name, new / name) for name in found.common_dirs)


@pytest.fixture(scope="module")
def copy(tmp_path_factory):
    folder = tmp_path_factory.mktemp("added")
    shutil.copytree(PACKAGE, folder / PACKAGE.name, ignore=shutil.ignore_patterns("__pycache__"))
    add_law(folder / PACKAGE.name)
    return folder


@pytest.mark.slow
def test_a_law_costs_two_files(copy):
    assert changed(PACKAGE, copy / PACKAGE.name) == 2


@pytest.mark.slow
def test_an_added_law_is_proved_simulated_and_exported(copy, tmp_path):
    """Continuous and sampled, from the command line; the C compiles, and meets its vectors."""
    text = text_of({"push": LAG}, scenario="command: {points: [[0 s, 4 deg/s], [1 s, 4 deg/s]]}")
    for name, more in (("continuous", ""), ("sampled", SAMPLED)):
        named = text.replace("name: small", f"name: {name}") + more
        (tmp_path / f"{name}.nrs.yaml").write_text(named, encoding="utf-8")
    for command in COMMANDS:
        done = subprocess.run(
            [sys.executable, "-m", PACKAGE.name, *command],
            cwd=tmp_path,
            env=os.environ | {"PYTHONPATH": str(copy)},
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, (command, done.stdout, done.stderr)
    # The exit code says which case of the vectors is the first to differ.
    reports, program = tmp_path / "reports", tmp_path / "program"
    main = reports / "main.c"
    main.write_text(MAIN)
    sources = [main, reports / "sampled.c", reports / "sampled_test.c"]
    subprocess.run([compiler(), *STRICT, *sources, "-o", program], check=True)
    assert subprocess.run([program], check=False).returncode == 0
