"""`nrs-design robot track`, as a user types it."""

import pytest

from nrs_design.spec.templates import TEMPLATES
from tests.support import ROOT, document_of, run

ROBOT = ROOT / "specs" / "robots" / "neuroboscope.nrs.yaml"
QUICK = ("--period", "0.5")


@pytest.fixture(scope="module")
def quick(tmp_path_factory):
    folder = tmp_path_factory.mktemp("track")
    return folder, document_of(
        "robot", "track", ROBOT, "--experiment", "phi", *QUICK, "--figures", "f", cwd=folder, code=0
    )


@pytest.mark.slow
def test_every_controller_in_one_document(quick):
    _, found = quick
    assert found["schema"] == "nrs-design/robot-track/1"
    controllers = ["computed-torque", "independent-joint", "balanced"]
    assert [run["controller"] for run in found["runs"]] == controllers
    assert {run["moved"] for run in found["runs"]} == {"phi"}
    assert found["base_tilt"] == pytest.approx(-0.497419, abs=1e-6)
    assert any("backlash" in line for line in found["not_modelled"])
    # Nothing was measured at this period.
    assert {run["measured_on_robot"] for run in found["runs"]} == {None}


def test_figures(quick):
    folder, found = quick
    assert sorted(found["files"]) == ["f/tracking.png", "f/tracking.svg"]
    assert (folder / "f/tracking.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.slow
def test_table_for_people_beside_the_print(tmp_path):
    # The shortest experiment of the thesis.
    given = ("--controller", "independent-joint", "--experiment", "phi")
    result = run("robot", "track", ROBOT, *given, cwd=tmp_path, code=0)
    (row,) = [line.split() for line in result.stdout.splitlines() if "independent-joint" in line]
    assert row[1:4] == ["phi", "10", "0.1075"]
    # Table 4.6.
    assert row[-3:] == ["0.0624", "0.0279", "0.1261"]
    assert "not modelled:" in result.stdout
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_a_robot_of_ones_own(tmp_path):
    text = TEMPLATES["robot"].replace("mass: 797.2 g", "mass: 900 g")
    (tmp_path / "mine.nrs.yaml").write_text(text[: text.index("# Thesis 4.4 and its")])
    result = run(
        "robot", "track", "mine.nrs.yaml", "--experiment", "d", *QUICK, cwd=tmp_path, code=0
    )
    assert "computed-torque" in result.stdout
    assert "balanced" not in result.stdout
    assert "on the robot" not in result.stdout


@pytest.mark.slow
def test_ablation(tmp_path):
    options = ("--controller", "independent-joint", "--experiment", "psi", *QUICK, "--ablation")
    result = run("robot", "track", ROBOT, *options, cwd=tmp_path, code=0)
    assert result.stdout.count("as designed") == 2
    assert "rotor inertia and motor damping in the law" in result.stdout
    assert "psi [deg]" in result.stdout
