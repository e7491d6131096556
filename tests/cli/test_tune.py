import pytest

from tests.support import ROBOT, run
from tests.tables import rows


@pytest.mark.parametrize("command", ["tune", "optimize"])
@pytest.mark.parametrize(
    ("name", "count", "worst"), rows(__file__, "test_all_that_is_doubtful_is_said_worst_first")
)
def test_all_that_is_doubtful_is_said_worst_first(tmp_path, command, name, count, worst):
    said = run(command, ROBOT / f"{name}.nrs.yaml", cwd=tmp_path, code=0).stderr
    assert said.startswith(f"warning: {worst}")
    assert said.count("warning: ") == count
