"""`nrs-design tune`, as a user types it."""

import pytest

from tests.support import FORCE_LIMIT, ROBOT, SOFT_TISSUE, document_of, run

GIVEN = """motion_loop:
  transfer_function: {numerator: [28.416, 1618.80], denominator: [1, 56.89, 1618.80]}
"""


def test_given_motion_loop_is_said_to_be_given(tmp_path):
    text = SOFT_TISSUE.read_text().replace("motion_loop:\n", GIVEN)
    (tmp_path / "given.nrs.yaml").write_text(text)
    assert "The spec states this G itself" in run("tune", "given.nrs.yaml", cwd=tmp_path).stdout
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
    assert "steady force error" not in result.stderr


def test_a_force_error_without_goal_is_warned_of(tmp_path):
    text = FORCE_LIMIT.read_text().replace("    goals: {max_force_error: 0.55}\n", "")
    (tmp_path / "free.nrs.yaml").write_text(text)
    result = run("tune", "free.nrs.yaml", cwd=tmp_path, code=0)
    for words in ("force-limit: Motion loop", "force-limit: Force controllers", "2060"):
        assert words in result.stdout
    assert "warning: force: steady force error over command 0.5465" in result.stderr


@pytest.mark.parametrize("command", ["tune", "optimize"])
@pytest.mark.parametrize(
    ("name", "count", "worst"),
    [
        ("soft-tissue", 3, "withdrawal: sensitivity peak Ms 3.753"),
        ("nose", 2, "insertion: Mt is on its lower bound"),
    ],
)
def test_all_that_is_doubtful_is_said_worst_first(tmp_path, command, name, count, worst):
    said = run(command, ROBOT / f"{name}.nrs.yaml", cwd=tmp_path, code=0).stderr
    assert said.startswith(f"warning: {worst}")
    assert said.count("warning: ") == count
