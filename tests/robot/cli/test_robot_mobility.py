"""``nrs-design robot mobility``, and the gate of the axes of an arm, as typed."""

import json
import shutil
from fractions import Fraction

import pytest

from tests.support import ROOT, run

EXAMPLE = ROOT / "docs/examples/six-torques.nrs.yaml"


@pytest.fixture
def copy(tmp_path):
    def written(*changes):
        text = EXAMPLE.read_text(encoding="utf-8")
        for old, new in changes:
            assert old in text
            text = text.replace(old, new)
        path = tmp_path / EXAMPLE.name
        path.write_text(text, encoding="utf-8")
        shutil.copy(EXAMPLE.with_name("arm.urdf"), tmp_path)
        return path

    return written


def test_the_example_is_shown():
    result = run("robot", "mobility", EXAMPLE, cwd=ROOT)
    assert result.returncode == 0
    head, lowest, highest = result.stdout.splitlines()
    assert head == "arm: PROVED: eigenvalues in [0.7, 1.4] with x, y, z, rx, ry, rz"
    assert lowest.startswith("  found 0.837")
    assert highest.startswith("  found 1.213")


def test_a_pose_that_is_beyond_is_named(copy, tmp_path):
    path = copy(("mobility: [0.7, 1.4]", "mobility: [0.9, 1.2]"))
    result = run("robot", "mobility", path, cwd=tmp_path)
    assert result.returncode == 1
    assert "REFUTED" in result.stdout
    assert "write `mobility: [0.796, 1.27]`" in result.stdout
    said = json.loads(run("robot", "mobility", path, "--json", cwd=tmp_path).stdout)
    assert said["verdict"] == "refuted"
    assert said["joints"] == ["q1", "q2", "q3", "q4", "q5", "q6"]
    assert said["found"][0] < 0.9


def test_too_little_work_decides_nothing(copy, tmp_path):
    path = copy(("mobility: [0.7, 1.4]", "mobility: [0.835, 1.215]"))
    result = run("robot", "mobility", path, "--budget", "0.1", cwd=tmp_path)
    assert result.returncode == 3
    assert "INCONCLUSIVE" in result.stdout
    assert "give more --budget" in result.stdout


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("        q6: [-6 deg, 6 deg]\n", "", "nothing is said of joint 'q6'"),
        ("q6: [-6 deg, 6 deg]", "q6: [-6 deg, 6 deg]\n        q7: 0 deg", "no joint 'q7'"),
        ("q6: [-6 deg, 6 deg]", "q6: [-6 mm, 6 mm]", "joint 'q6' turns"),
        ("q6: [-6 deg, 6 deg]", "q6: [-6 deg, 6 mm]", "one end of the range of q6 is an angle"),
        ("q6: [-6 deg, 6 deg]", "q6: [6 deg, -6 deg]", "the range of q6 ends at"),
        ("q6: [-6 deg, 6 deg]", "q6: [-6 deg, 200 deg]", "'q6' is used beyond its limits"),
        ("tip: tip", "tip: top", "there is no link 'top'"),
        ("model: arm.urdf", "model: other.urdf", "there is no model 'other.urdf'"),
        ("  rz:\n", "  yaw:\n", "axis 'yaw' is none of the tip"),
        ("  z:\n    axis: prismatic", "  q:\n    axis: prismatic", "axis 'q' is none of the tip"),
        ("    mobility: [0.7, 1.4]\n", "", "an arm is given, and no mobility"),
        ("common:\n  coupling:", "common:\n  title:", "title"),
    ],
)
def test_what_does_not_fit_is_refused(copy, tmp_path, old, new, said):
    result = run("robot", "mobility", copy((old, new)), cwd=tmp_path)
    assert result.returncode == 2
    assert said in result.stderr.replace("\n", " ")
    assert result.stdout == ""


def test_a_spec_without_an_arm_is_refused(tmp_path):
    axes = EXAMPLE.with_name("six-axes.nrs.yaml")
    result = run("robot", "mobility", axes, cwd=tmp_path)
    assert result.returncode == 2
    assert "no arm is named" in result.stderr


def test_a_gate_computes_the_mobility_again(copy, tmp_path):
    """A range that a pose is beyond misses NRS111, although every axis is proved with it."""
    good = copy()
    result = run("gate", f"{good}#z", "--no-reports", cwd=tmp_path)
    assert result.returncode == 0, result.stdout
    locked = run("gate", f"{good}#z", "--locked", cwd=tmp_path)
    assert locked.returncode == 0
    assert "taken on trust: the bounds of" in locked.stderr
    # Another arm is another spec.
    arm = tmp_path / "arm.urdf"
    text = arm.read_text(encoding="utf-8")
    arm.write_text(text.replace('mass value="3.2"', 'mass value="3.3"'), encoding="utf-8")
    changed = run("gate", f"{good}#z", "--locked", cwd=tmp_path)
    assert changed.returncode == 1
    assert "has changed since it was locked" in changed.stdout
    bad = copy(("mobility: [0.7, 1.4]", "mobility: [0.9, 1.2]"))
    result = run("gate", f"{bad}#z", "--no-reports", cwd=tmp_path)
    assert result.returncode == 1
    assert "NRS111" in result.stdout
    assert "the lowest mobility is said to be 0.9, and is 0.8" in result.stdout


def test_all_axes_are_proved_together(copy, tmp_path):
    """One line after those of the axes: the worst of their rates."""
    path = copy()
    result = run("certify-switching", path, "--json", cwd=tmp_path)
    assert result.returncode == 0
    said = json.loads(result.stdout)
    assert [axis.rpartition("#")[2] for axis in said["axes"]] == ["x", "y", "z", "rx", "ry", "rz"]
    rates = [Fraction(axis["decay_rate_exact"]) for axis in said["axes"].values()]
    assert said["together"] == {"verdict": "proved", "rate": str(max(rates))}


def test_axes_alone_are_not_proved_together(tmp_path):
    axes = EXAMPLE.with_name("six-axes.nrs.yaml")
    result = run("certify-switching", axes, cwd=tmp_path)
    assert result.returncode == 0
    assert result.stdout.count("PROVED") == 6
    assert "together" not in result.stdout
    refused = run("certify-switching", axes, "--out", "one.json", cwd=tmp_path)
    assert refused.returncode == 2
    assert "one file is not enough for several axes" in refused.stderr
