"""`nrs-design tune`, as a user types it."""

import json

import pytest

from tests.support import FORCE_LIMIT, ROBOT, SOFT_TISSUE, document_of, run

GIVEN = """motion_loop:
  transfer_function: {numerator: [28.416, 1618.80], denominator: [1, 56.89, 1618.80]}
"""


def test_motion_loop_of_the_thesis(tmp_path):
    """Thesis 4.3: zero 56.9706, gain 2065.4 (2060 used), poles -28.453 +- 28.448j, 6.8 %."""
    document = document_of("tune", FORCE_LIMIT, cwd=tmp_path, code=0)
    assert document["schema"] == "nrs-design/tune/1"
    motion = document["motion"]
    assert motion["root_locus"]["zero"] == pytest.approx(56.9706, rel=5e-4)
    assert motion["root_locus"]["derivative_gain"] == pytest.approx(2065.4, rel=1e-3)
    assert motion["Kd"] == 2060
    assert motion["Kp"] == 117359.4375
    upper = next(pole for pole in motion["poles"] if pole[1] > 0)
    assert upper == pytest.approx([-28.453, 28.448], rel=1e-3)
    assert motion["overshoot_percent"] == pytest.approx(6.8, abs=0.2)


def test_force_loop_of_the_thesis(tmp_path):
    """Thesis 6.3.3.1: Kp = 0.02; the damping ratio it really gives is 0.741 at 54.9 rad/s."""
    (force,) = document_of("tune", FORCE_LIMIT, cwd=tmp_path)["force"]
    assert force["name"] == "force"
    assert force["Kp"] == pytest.approx(0.02)
    assert force["damping_ratio"] == pytest.approx(0.741, abs=1e-3)
    assert force["natural_frequency"] == pytest.approx(54.9, abs=0.1)


def test_force_limit_with_its_offset(tmp_path):
    """The numbers are those of the law as declared: 8 deg/s, Fd = 0.3 N m."""
    shown = run("tune", ROBOT / "force-limit-offset.nrs.yaml", cwd=tmp_path).stdout
    assert "X_i is the measured position at the switch" in shown
    assert "peaks at 0.324 N m and settles 0.00 % off 0.3 N m" in shown
    spec = tmp_path / "reference.nrs.yaml"
    text = (ROBOT / "force-limit-offset.nrs.yaml").read_text()
    spec.write_text(text.replace("offset: measured", "offset: reference"))
    result = run("tune", spec, "--json", cwd=tmp_path)
    (force,) = json.loads(result.stdout)["force"]
    assert force["offset"] == "reference"
    assert force["steady_state_ratio"] == pytest.approx(0.1894, abs=1e-4)
    assert force["peak_torque"] == pytest.approx(0.3763, abs=1e-4)
    # That misses the goal of the spec.
    assert result.returncode == 1
    (goal,) = [goal for goal in force["goals"] if goal["goal"] == "max_force_error"]
    assert goal["status"] == "missed"


def test_given_motion_loop_is_said_to_be_given(tmp_path):
    text = SOFT_TISSUE.read_text().replace("motion_loop:\n", GIVEN)
    (tmp_path / "given.nrs.yaml").write_text(text)
    assert "The spec states G itself" in run("tune", "given.nrs.yaml", cwd=tmp_path).stdout
    document = document_of("tune", "given.nrs.yaml", cwd=tmp_path)
    assert document["motion"]["loop"]["source"] == "given"


def test_gains_beyond_single_precision(tmp_path):
    text = SOFT_TISSUE.read_text()
    text = text.replace("2060 rpm*s/rad", "1e29 rpm*s/rad").replace("56.9706 1/s", "1e29 1/s")
    (tmp_path / "huge.nrs.yaml").write_text(text)
    assert "single precision" in run("tune", "huge.nrs.yaml", cwd=tmp_path, code=2).stderr


@pytest.mark.parametrize(("goal", "code", "word"), [("0.55", 0, "met"), ("0.5", 1, "MISSED")])
def test_goal_of_the_force_error(tmp_path, goal, code, word):
    """Kp = 0.02 leaves 1/(1 + 0.02 * 41.5043) of the command at the softest tissue."""
    text = FORCE_LIMIT.read_text().replace("max_force_error: 0.55", f"max_force_error: {goal}")
    (tmp_path / "goals.nrs.yaml").write_text(text)
    result = run("tune", "goals.nrs.yaml", cwd=tmp_path, code=code)
    row = next(line for line in result.stdout.splitlines() if "steady force error" in line)
    assert "0.5465" in row
    assert "k = 41.5043 N*m/rad" in row
    assert row.rstrip().endswith(word)
    assert "warning" not in result.stderr


def test_a_force_error_without_goal_is_warned_of(tmp_path):
    text = FORCE_LIMIT.read_text().replace("    goals: {max_force_error: 0.55}\n", "")
    (tmp_path / "free.nrs.yaml").write_text(text)
    result = run("tune", "free.nrs.yaml", cwd=tmp_path, code=0)
    for words in ("force-limit: motion loop", "force-limit: force loop", "2060"):
        assert words in result.stdout
    assert "warning: force: steady force error over command 0.5465" in result.stderr


@pytest.mark.parametrize("name", ["soft-tissue", "force-limit", "nose"])
def test_what_optimize_marks_is_not_warned_of_here(tmp_path, name):
    for command in ("tune", "optimize"):
        result = run(command, ROBOT / f"{name}.nrs.yaml", cwd=tmp_path, code=0)
        assert "warning" not in result.stderr, command
