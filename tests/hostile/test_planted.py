"""No command executes a module of the working folder, whose every module is a stranger's."""

import ast
import shutil
import sys
from importlib.metadata import packages_distributions

import pytest

from tests.package import FILES, nodes_of
from tests.support import COMMUTING, ROOT, SOFT_TISSUE, started

EXAMPLES = ROOT / "docs" / "examples"
NAMES = (sys.stdlib_module_names | packages_distributions().keys()) - {"nrs_design"}
PLANTED = "import os\nopen(os.environ['EXECUTED'], 'a').write(__name__ + '\\n')\n"
RANGE = "environments.soft.stiffness=700,2000 N/m"
COMMANDS = (
    ("gate", "--jobs", "2", "--no-reports", "."),
    ("sweep", SOFT_TISSUE, "--set", RANGE, "--jobs", "2", "certify-switching"),
    ("export", SOFT_TISSUE, "--format", "fmu"),
    ("certify-switching", COMMUTING),
    ("audit", "x.csv", SOFT_TISSUE),
    ("robot", "kinematics", ROOT / "specs/robots/neuroboscope.nrs.yaml"),
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
    assert found == {"nrs_design.pipeline.processes"}


@pytest.mark.parametrize(
    "command",
    [COMMANDS[0], *(pytest.param(c, marks=pytest.mark.slow) for c in COMMANDS[1:])],
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
    given = {"EXECUTED": str(executed), "HOME": str(tmp_path)}
    done = started("-P", "-m", "nrs_design", *command, cwd=folder, **given)
    assert 0 <= done.returncode < 4, done.stderr
    assert not executed.exists(), executed.read_text()
