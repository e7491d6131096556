"""`nrs-design robot`, as a user types it."""

import pytest

from tests.support import ROOT, run

ROBOT = ROOT / "specs" / "robots" / "neuroboscope.nrs.yaml"
COMMANDS = ("check", "kinematics", "dynamics", "correction", "balance")


@pytest.mark.parametrize(
    "command",
    [pytest.param(c, marks=[pytest.mark.slow] if c == "correction" else []) for c in COMMANDS],
)
def test_tables_for_people(tmp_path, command):
    result = run("robot", command, ROBOT, cwd=tmp_path, code=int(command == "check"))
    assert len(result.stdout.splitlines()) > 3
