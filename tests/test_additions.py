"""What is added to a copy of the package: how many files it costs, and that it works end to end."""

import filecmp
import json
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.exporters.programs import STRICT, compiler
from tests.package import PACKAGE
from tests.simulation.interactions import text_of
from tests.support import started
from tests.tables import spec_text

ADDITIONS = Path(__file__).parent / "additions"
LAG = "{type: lag-force, environment: soft, gain: 0.01 rad/(N*m), lag: 50 ms}"
RUBBER = "{model: rubber, stiffness: 40 N*m/rad, damping: 1 N*m*s/rad}"
SAMPLED = "sampling: {period: 2 ms, delay: [0, 1]}\ncontact: kept\n"
TWO_MODES = spec_text("two-steps")
MAIN = """#include "sampled_test.h"
int main(void) { return (int)nrs_sampled_self_test() + 1; }
"""
PROVED = (
    ("certify-switching", "continuous.nrs.yaml", "--out", "reports/continuous.cert.json"),
    ("verify", "reports/continuous.cert.json", "continuous.nrs.yaml"),
    ("certify-switching", "sampled.nrs.yaml", "--out", "reports/sampled.cert.json"),
    ("verify", "reports/sampled.cert.json", "sampled.nrs.yaml"),
)
DONE = (
    *PROVED,
    ("simulate", "sampled.nrs.yaml", "--engine", "sampled"),
    ("simulate", "continuous.nrs.yaml", "--engine", "exact"),
    ("export", "sampled.nrs.yaml", "--format", "c"),
)


def insert(file: Path, before: str, text: str) -> None:
    """Write text into a file, in front of what stands there once."""
    old = file.read_text(encoding="utf-8")
    assert old.count(before) == 1, before
    file.write_text(old.replace(before, f"{text}{before}"), encoding="utf-8")


def add_law(package: Path) -> None:
    shutil.copy(ADDITIONS / "lag_force.py", package / "controllers" / "laws")
    spec = package / "spec" / "controllers.py"
    model = (ADDITIONS / "lag_force_spec.txt").read_text(encoding="utf-8")
    insert(spec, "ControllerSpec = Annotated[", model)
    insert(spec, "    | PositionControllerSpec,", "    | LagForceControllerSpec\n")


def add_environment(package: Path) -> None:
    shutil.copy(ADDITIONS / "rubber.py", package / "models" / "contact")
    spec = package / "spec" / "environment.py"
    model = (ADDITIONS / "rubber_spec.txt").read_text(encoding="utf-8")
    insert(spec, "EnvironmentSpec = Annotated[\n", model)
    insert(spec, "ElasticSpec | KelvinVoigtSpec", "RubberSpec | ")
    line = "from nrs_design.models.contact.rubber import Rubber\n"
    insert(spec, "from nrs_design.models.interval import", line)


def add_shape(package: Path) -> None:
    """Add a graph of another shape: the file that draws it, and its rung of the ladder."""
    shutil.copy(ADDITIONS / "last_mode.py", package / "search")
    rung = """    Rung(
        "last mode",
        Method.MODE_QUADRATIC,
        lambda f: f.system.switching.is_arbitrary and not f.is_continuous(),
        _load_lazily("last_mode.search_last_mode"),
    ),
"""
    insert(package / "search" / "ladder.py", '    Rung(\n        "periodic quadratic",', rung)


def changed(old: Path, new: Path) -> int:
    """Count the files that one folder has not, or otherwise, than another."""
    found = filecmp.dircmp(old, new, ignore=["__pycache__"])
    own = len(found.right_only) + len(found.diff_files)
    return own + sum(changed(old / name, new / name) for name in found.common_dirs)


def copy_with(folder: Path, add: Callable[[Path], None]) -> Path:
    shutil.copytree(PACKAGE, folder / PACKAGE.name, ignore=shutil.ignore_patterns("__pycache__"))
    add(folder / PACKAGE.name)
    return folder


def run_all(copy: Path, folder: Path, commands: tuple[tuple[str, ...], ...]) -> None:
    for command in commands:
        done = started("-m", PACKAGE.name, *command, cwd=folder, PYTHONPATH=str(copy))
        assert done.returncode == 0, (command, done.stdout, done.stderr)


def write_specs(folder: Path, text: str) -> None:
    for name, more in (("continuous", ""), ("sampled", SAMPLED)):
        named = text.replace("name: small", f"name: {name}") + more
        (folder / f"{name}.nrs.yaml").write_text(named, encoding="utf-8")


@pytest.mark.parametrize("add", [add_law, add_environment, add_shape])
def test_an_addition_costs_two_files(add, tmp_path):
    assert changed(PACKAGE, copy_with(tmp_path, add) / PACKAGE.name) == 2


@pytest.mark.slow
def test_an_added_law_is_proved_simulated_and_exported(tmp_path):
    """Continuous and sampled, from the command line; the C compiles, and passes its self-test."""
    command = "command: {points: [[0 s, 4 deg/s], [1 s, 4 deg/s]]}"
    write_specs(tmp_path, text_of({"push": LAG}, scenario=command))
    run_all(copy_with(tmp_path / "copy", add_law), tmp_path, DONE)
    # The exit code says which case is the first to differ.
    reports, program = tmp_path / "reports", tmp_path / "program"
    main = reports / "main.c"
    main.write_text(MAIN)
    sources = [main, reports / "sampled.c", reports / "sampled_test.c"]
    subprocess.run([compiler(), *STRICT, *sources, "-o", program], check=True)
    assert subprocess.run([program], check=False).returncode == 0


@pytest.mark.slow
def test_an_added_environment_is_proved_simulated_and_exported(tmp_path):
    command = "command: {points: [[0 s, 4 deg/s], [1 s, 4 deg/s]]}"
    write_specs(tmp_path, text_of(environments={"soft": RUBBER}, scenario=command))
    run_all(copy_with(tmp_path / "copy", add_environment), tmp_path, DONE)


@pytest.mark.slow
def test_an_added_shape_of_a_graph_proves(tmp_path):
    """A form for each mode of the step before, at one place: the check needs nothing new."""
    (tmp_path / "two.nrs.yaml").write_text(TWO_MODES, encoding="utf-8")
    kept = ("--out", "reports/two.cert.json")
    commands = (
        ("certify-switching", "two.nrs.yaml", "--method", "mode-quadratic", *kept),
        ("verify", "reports/two.cert.json", "two.nrs.yaml"),
        ("report", "two.nrs.yaml"),
    )
    run_all(copy_with(tmp_path / "copy", add_shape), tmp_path, commands)
    document = json.loads((tmp_path / "reports" / "two.cert.json").read_text(encoding="utf-8"))
    (statement,) = document["statements"]
    assert [edge["mode"] for edge in statement["edges"]] == ["a", "b"]
