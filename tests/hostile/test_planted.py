"""No command executes a module of the working folder, whose every module is a stranger's."""

import ast
import os
import shutil
import subprocess
import sys
from importlib.metadata import packages_distributions

import pytest

from nrs_design.cli.app import COMMANDS
from tests.package import FILES, nodes_of
from tests.support import COMMUTING, ROOT, SOFT_TISSUE

EXAMPLES = ROOT / "docs" / "examples"
NAMES = (sys.stdlib_module_names | packages_distributions().keys()) - {"nrs_design"}
PLANTED = "import os\nopen(os.environ['EXECUTED'], 'a').write(__name__ + '\\n')\n"
RANGE = "environments.soft.stiffness=700,2000 N/m"
STARTS_OTHERS = (
    ("gate", "--jobs", "2", "--no-reports", "."),
    ("sweep", SOFT_TISSUE, "--no-store", "--set", RANGE, "--jobs", "2", "certify-switching"),
    ("export", SOFT_TISSUE, "--format", "fmu"),
)
OTHERS = (
    ("init", "robot"),
    ("identify", "tissue", "x.csv"),
    ("check", COMMUTING),
    ("explain", "NRS110"),
    ("schema",),
    ("optimize", SOFT_TISSUE),
    ("tune", SOFT_TISSUE),
    ("mode-logic", SOFT_TISSUE),
    ("simulate", SOFT_TISSUE),
    ("certify-switching", COMMUTING),
    ("verify", ROOT / "reports" / "commuting.cert.json"),
    ("compare-methods", COMMUTING),
    ("check-lyapunov", EXAMPLES / "lyapunov.json"),
    ("report", COMMUTING),
    ("diff", COMMUTING, SOFT_TISSUE),
    ("audit", "x.csv", SOFT_TISSUE),
    ("robot", "kinematics", ROOT / "specs/robots/neuroboscope.nrs.yaml"),
    ("ros2", "check", EXAMPLES / "admittance.ros2.yaml"),
    ("reproduce", "--help"),
)


def test_one_module_starts_processes():
    """But for the copy of this one that proves beside it."""
    starters = {"subprocess", "multiprocessing", "joblib", "concurrent", "fork", "spawnv", "popen"}
    found = {
        name
        for name, path in FILES.items()
        for node in nodes_of(path)
        if (isinstance(node, ast.Import) and starters & {a.name.split(".")[0] for a in node.names})
        or (isinstance(node, ast.ImportFrom) and starters & {str(node.module).split(".")[0]})
        or (isinstance(node, ast.Attribute) and node.attr in starters)
    }
    # It names the error of a pool that broke.
    assert found - {"nrs_design.sweeps.spread"} == {"nrs_design.processes"}


def test_every_command_is_here():
    assert {first for first, *_ in STARTS_OTHERS + OTHERS} == set(COMMANDS)


@pytest.mark.parametrize(
    "command",
    [
        STARTS_OTHERS[0],
        *(pytest.param(c, marks=pytest.mark.slow) for c in STARTS_OTHERS[1:] + OTHERS),
    ],
    ids=lambda command: command[0],
)
def test_nothing_that_was_planted_is_executed(tmp_path, command):
    executed, folder = tmp_path / "executed", tmp_path / "work"
    folder.mkdir()
    for name in NAMES:
        (folder / f"{name}.py").write_text(PLANTED)
    (folder / "x.csv").write_text("time_s,deflection_m,force_N\n0,0,0\n")
    for name in "ab":
        shutil.copy(COMMUTING, folder / f"{name}.nrs.yaml")
    # As the installed program starts, which has its own folder in front.
    started = [sys.executable, "-P", "-m", "nrs_design", *map(str, command)]
    env = os.environ | {"EXECUTED": str(executed), "HOME": str(tmp_path)}
    done = subprocess.run(started, cwd=folder, env=env, capture_output=True, text=True)
    assert 0 <= done.returncode < 4, done.stderr
    assert not executed.exists(), executed.read_text()
