"""`nrs-design robot`, as a user types it."""

import csv

import pytest

from tests.support import ROOT, document_of, run

ROBOT = ROOT / "specs" / "robots" / "neuroboscope.nrs.yaml"
COMMANDS = ("check", "kinematics", "dynamics", "correction", "balance")


def document(*arguments, cwd):
    found = document_of(
        "robot", arguments[0], ROBOT, *arguments[1:], cwd=cwd, code=int(arguments[0] == "check")
    )
    assert found["schema"] == f"nrs-design/robot-{arguments[0]}/1"
    assert found["spec"] == "neuroboscope"
    return found


@pytest.mark.slow
def test_correction_table_for_the_controller(tmp_path):
    found = document("correction", "--table", "K.csv", cwd=tmp_path)
    assert found["files"] == ["K.csv"]
    with (tmp_path / "K.csv").open() as file:
        rows = list(csv.DictReader(file))
    by_tilt = {float(row["theta4_deg"]): row for row in rows}
    assert (len(rows), min(by_tilt), max(by_tilt)) == (76, -75, 0)
    assert float(by_tilt[-40]["K3"]) == pytest.approx(2.162, abs=6e-4)


@pytest.mark.parametrize(
    "command",
    [pytest.param(c, marks=[pytest.mark.slow] if c == "correction" else []) for c in COMMANDS],
)
def test_tables_for_people(tmp_path, command):
    result = run("robot", command, ROBOT, cwd=tmp_path, code=int(command == "check"))
    assert len(result.stdout.splitlines()) > 3
