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


def test_dynamics_at_home(tmp_path):
    found = document("dynamics", "--pose", "0,0,0.2", cwd=tmp_path)
    assert found["G"] == pytest.approx([-3.334268, 3.327126, 2.913252], abs=1e-6)
    assert found["Gs"] == pytest.approx([-1.829253, 1.829253, 1.309862], abs=1e-6)
    assert [found["M"][i][i] for i in range(3)] == pytest.approx(
        [0.146025, 0.145811, 0.047898], abs=1e-6
    )
    assert found["torque"] == pytest.approx(found["G"])


def test_torques_of_a_motion(tmp_path):
    motion = ("--velocity", "0.5,-0.3,0.8", "--acceleration", "1,2,-1")
    found = document("dynamics", "--pose", "0.1,-0.2,0.2", *motion, cwd=tmp_path)
    assert found["torque"] == pytest.approx([-3.412764, 3.142030, 2.681441], abs=1e-6)


def test_negative_angles_and_tilt(tmp_path):
    found = document("dynamics", "--pose=-0.1,-0.2,0.2", "--tilt", "-28.5", cwd=tmp_path)
    assert found["base_tilt"] == pytest.approx(-0.49742, abs=1e-5)


def test_shares_of_the_torque(tmp_path):
    found = document("dynamics", cwd=tmp_path)
    assert found["mean_shares"]["gravity"] == pytest.approx(0.7551, abs=1e-4)


def test_kinematics_there_and_back(tmp_path):
    there = document("kinematics", "--pose", "0.1,-0.2,0.2", cwd=tmp_path)
    assert there["joints"] == pytest.approx([0.21320221, -0.07155944, 0.80477127], abs=1e-8)
    joints = ",".join(map(repr, there["joints"]))
    back = document("kinematics", "--joints", joints, cwd=tmp_path)
    assert back["pose"] == pytest.approx([0.1, -0.2, 0.2], abs=1e-14)


def test_workspace(tmp_path):
    found = document("kinematics", cwd=tmp_path)
    assert 0.999 < found["reachable_share"] < 1
    assert found["joint_low"][2] == pytest.approx(-1.119, abs=1e-3)


def test_check(tmp_path):
    found = document("check", cwd=tmp_path)
    assert found["valid"] is True
    assert min(found["mass_matrix_eigenvalues_at_home"]) > 0
    assert len(found["corners"]) == 4
    assert "psi -20 deg, d 250 mm is not reachable: the left leg" in found["obstacle"]


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


@pytest.mark.parametrize(
    ("pose", "said"),
    [
        ("0,0,200", "depths are in m: 200 mm are 0.2"),
        ("10,0,0.2", "angles are in rad: 10 deg are 0.174533"),
        ("0,-5,0.2", "angles are in rad: -5 deg are -0.0872665"),
    ],
)
def test_a_pose_in_other_units_is_doubted(tmp_path, pose, said):
    for command in ("kinematics", "dynamics"):
        result = run("robot", command, ROBOT, "--pose", pose, cwd=tmp_path)
        assert (result.returncode, result.stdout) == (2, "")
        assert said in result.stderr


def test_columns_are_named(tmp_path):
    text = run("robot", "kinematics", ROBOT, "--pose", "0,0,0.2", cwd=tmp_path).stdout
    lines = [line.split() for line in text.splitlines()]
    assert ["SI", "units", "phi", "psi", "d"] in lines
    assert ["SI", "units", "theta1", "theta2", "theta3"] in lines
    assert ["Jacobian:", "phi", "0.70710678", "0.70710678", "0"] in lines
    assert any(line[2:4] == ["left", "leg"] for line in lines)


def test_check_refuses_a_robot_without_mass(tmp_path):
    text = re.sub(r"mass: [0-9.]+ g", "mass: 0 g", TEMPLATES["robot"])
    (tmp_path / "light.nrs.yaml").write_text(text.replace("14.81e-7 kg*m^2", "0 kg*m^2", 1))
    result = run("robot", "check", "light.nrs.yaml", cwd=tmp_path, code=2)
    assert result.stdout == ""
    assert "some motion of the robot moves no mass" in result.stderr


def test_balance(tmp_path):
    found = document("balance", cwd=tmp_path)
    assert found["left"]["stiffness"] == pytest.approx(1804.2, abs=0.1)
    assert max(found["with_balance"]["rms"]) < min(found["without_balance"]["rms"]) / 4


@pytest.mark.slow
def test_correction_table_replaces_tables_only(tmp_path):
    record = tmp_path / "record.csv"
    record.write_text("time,force")
    run("robot", "correction", ROBOT, "--table", "record.csv", cwd=tmp_path, code=2)
    assert record.read_text() == "time,force"


@pytest.mark.slow
def test_correction_table_for_the_controller(tmp_path):
    found = document("correction", "--table", "K.csv", "--figures", "out", cwd=tmp_path)
    assert found["trajectories"][0]["mean_ratio"] == pytest.approx([1.823, 1.819, 2.282], abs=6e-4)
    drawn = [f"out/{name}.{end}" for name in PICTURES for end in ("svg", "png")]
    assert found["files"] == ["K.csv", *drawn]
    assert (tmp_path / "out" / "inertia-errors.png").stat().st_size > 10_000
    errors = found["apart"]["inertia_error"]
    assert errors["single"] > errors["rows"] > errors["entries"] > found["apart"]["gravity_error"]
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
        (("dynamics", ROBOT, "--pose", "0,0"), "three numbers"),
        (("dynamics", ROBOT, "--pose", "0,0,nan"), "three numbers"),
        (("dynamics", ROBOT, "--velocity", "1,1,1"), "--pose"),
        (("kinematics", ROBOT, "--pose", "0,0,0.2", "--joints", "0,0,0"), "not both"),
        (("kinematics", ROBOT, "--pose", "0,0,0.5"), "overstretched by"),
        (("kinematics", ROBOT, "--joints=0.9,-0.9,-1.6"), "too far from the endoscope"),
        (("check", SOFT_TISSUE), "describes no robot"),
        (("check", "missing.nrs.yaml"), "no such file"),
    ],
)
def test_wrong_use_is_one_message_and_exit_code_2(tmp_path, arguments, said):
    result = run("robot", *arguments, cwd=tmp_path, code=2)
    assert said in " ".join(result.stderr.replace("│", " ").split())
    assert result.stdout == ""


def test_no_balance_in_the_spec(tmp_path):
    text = TEMPLATES["robot"]
    (tmp_path / "bare.nrs.yaml").write_text(text[: text.index("# Thesis 4.4 and its")])
    assert "no `balance`" in run("robot", "balance", "bare.nrs.yaml", cwd=tmp_path, code=2).stderr


def test_other_commands_say_that_a_robot_has_nothing_to_certify(tmp_path):
    for command in ("certify-switching", "optimize", "tune", "export"):
        assert "robot" in run(command, ROBOT, cwd=tmp_path, code=2).stderr
    assert list(tmp_path.iterdir()) == []


def test_a_fresh_robot_spec_is_valid(tmp_path):
    run("init", "robot", "--out", "mine.nrs.yaml", cwd=tmp_path, code=0)
    run("check", "-q", "mine.nrs.yaml", cwd=tmp_path, code=0)
    assert "valid robot 'mine'" in run("robot", "check", "mine.nrs.yaml", cwd=tmp_path).stdout


def test_help_imports_nothing_heavy(tmp_path):
    result = run("robot", "--help", cwd=tmp_path, code=0)
    assert all(command in result.stdout for command in COMMANDS)
