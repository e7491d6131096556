"""`nrs-design tune`, as a user types it."""

import pytest

from tests.support import ROBOT, run


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
