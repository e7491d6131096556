"""`nrs-design robot`, as a user types it."""

import csv

import pytest

from tests.support import ROOT, document_of, run

ROBOT = ROOT / "specs" / "robots" / "neuroboscope.nrs.yaml"
COMMANDS = ("check", "kinematics", "dynamics", "correction", "balance")
PICTURES = ("correction", "inertia-errors")


def document(*arguments, cwd):
    found = document_of(
        "robot", arguments[0], ROBOT, *arguments[1:], cwd=cwd, code=int(arguments[0] == "check")
    )
    assert found["schema"] == f"nrs-design/robot-{arguments[0]}/1"
    assert found["spec"] == "neuroboscope"
    return found


@pytest.mark.slow
def test_correction_table_for_the_controller(tmp_path):
    found = document("correction", "--table", "K.csv", "--figures", "out", cwd=tmp_path)
    drawn = [f"out/{name}.{end}" for name in PICTURES for end in ("svg", "png")]
    assert found["files"] == ["K.csv", *drawn]
    assert (tmp_path / "out" / "inertia-errors.png").stat().st_size > 10_000
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
    assert ("inertia, by entries" in result.stdout) is (command == "correction")


@pytest.mark.parametrize(
    ("command", "name"),
    [
        pytest.param("kinematics", "workspace", marks=pytest.mark.slow),
        pytest.param("dynamics", "torque-shares", marks=pytest.mark.slow),
        ("balance", "balance"),
    ],
)
def test_figures(tmp_path, command, name):
    found = document(command, "--figures", "drawn", "-q", cwd=tmp_path)
    assert sorted(found["files"]) == [f"drawn/{name}.png", f"drawn/{name}.svg"]
    assert (tmp_path / f"drawn/{name}.png").read_bytes().startswith(b"\x89PNG")
    svg = (tmp_path / f"drawn/{name}.svg").read_text()
    assert "<svg" in svg
    document(command, "--figures", "again", "-q", cwd=tmp_path)
    assert (tmp_path / f"again/{name}.svg").read_text() == svg
