"""`nrs-design robot`, as a user types it."""

import csv
import re

import pytest

from nrs_design.spec.templates import TEMPLATES
from tests.support import ROOT, SOFT_TISSUE, document_of, run

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


ASIDE = [0.1, -0.2, 0.2]
MOVED = ("--pose", "0.1,-0.2,0.2", "--velocity", "0.5,-0.3,0.8", "--acceleration", "1,2,-1")


@pytest.mark.parametrize(
    ("command", "options", "facts"),
    [
        ("dynamics", MOVED, {"torque": [-3.412764, 3.14203, 2.681441]}),
        ("dynamics", ("--pose=-0.1,-0.2,0.2", "--tilt", "-28.5"), {"base_tilt": -0.497419}),
        ("kinematics", ("--joints", "0.21320221,-0.07155944,0.80477127"), {"pose": ASIDE}),
    ],
)
def test_facts(tmp_path, command, options, facts):
    found = document(command, *options, cwd=tmp_path)
    for name, value in facts.items():
        assert found[name] == pytest.approx(value, abs=1e-6)


def test_check_says_what_is_out_of_reach_and_why(tmp_path):
    result = run("robot", "check", ROBOT, "-q", cwd=tmp_path)
    assert (result.returncode, result.stdout) == (1, "")
    line = ROBOT.read_text().splitlines().index("workspace:") + 1
    assert f"neuroboscope.nrs.yaml:{line}: 0.05 % of the declared workspace" in result.stderr
    assert "the left leg is overstretched by 5.507 mm" in result.stderr


def test_check_of_a_workspace_within_reach(tmp_path):
    text = ROBOT.read_text().replace("max: 250 mm}", "max: 244 mm}")
    (tmp_path / "mine.nrs.yaml").write_text(text)
    result = run("robot", "check", "mine.nrs.yaml", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    assert "every pose of a grid over the workspace is reachable" in result.stdout


def test_columns_are_named(tmp_path):
    text = run("robot", "kinematics", ROBOT, "--pose", "0,0,0.2", cwd=tmp_path).stdout
    lines = [line.split() for line in text.splitlines()]
    assert ["SI", "units", "phi", "psi", "d"] in lines
    assert ["SI", "units", "theta1", "theta2", "theta3"] in lines
    assert ["Jacobian:", "phi", "0.70710678", "0.70710678", "0"] in lines
    assert any(line[2:4] == ["left", "leg"] for line in lines)


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


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("dynamics", ROBOT, "--pose", "10,0,0.2"), "angles are in rad: 10 deg are 0.174533"),
        (("dynamics", ROBOT, "--velocity", "1,1,1"), "--pose"),
        (("kinematics", ROBOT, "--pose", "0,0,0.2", "--joints", "0,0,0"), "not both"),
        (("kinematics", ROBOT, "--pose", "0,0,0.5"), "overstretched by"),
        (("kinematics", ROBOT, "--joints=0.9,-0.9,-1.6"), "too far from the endoscope"),
        (("check", SOFT_TISSUE), "describes no robot"),
        (("check", "missing.nrs.yaml"), "no such file"),
        (("check", "light.nrs.yaml"), "some motion of the robot moves no mass"),
        (("balance", "bare.nrs.yaml"), "no `balance`"),
        (("correction", ROBOT, "--table", "record.csv"), "record.csv"),
    ],
)
def test_wrong_use_is_one_message_and_exit_code_2(tmp_path, arguments, said):
    text = re.sub(r"mass: [0-9.]+ g", "mass: 0 g", TEMPLATES["robot"])
    (tmp_path / "light.nrs.yaml").write_text(text.replace("14.81e-7 kg*m^2", "0 kg*m^2", 1))
    (tmp_path / "bare.nrs.yaml").write_text(text[: text.index("# Thesis 4.4 and its")])
    (tmp_path / "record.csv").write_text("time,force")
    result = run("robot", *arguments, cwd=tmp_path, code=2)
    assert said in " ".join(result.stderr.replace("│", " ").split())
    assert result.stdout == ""
    assert (tmp_path / "record.csv").read_text() == "time,force"


def test_other_commands_say_that_a_robot_has_nothing_to_certify(tmp_path):
    for command in ("certify-switching", "optimize", "tune", "export"):
        assert "robot" in run(command, ROBOT, cwd=tmp_path, code=2).stderr
    assert list(tmp_path.iterdir()) == []


def test_a_fresh_robot_spec_is_valid(tmp_path):
    run("init", "robot", "--out", "mine.nrs.yaml", cwd=tmp_path, code=0)
    run("check", "-q", "mine.nrs.yaml", cwd=tmp_path, code=0)
    assert "valid robot 'mine'" in run("robot", "check", "mine.nrs.yaml", cwd=tmp_path).stdout
