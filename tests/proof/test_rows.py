"""What the tables beside the tests of evidence say, row by row: see rows.py."""

from pathlib import Path

import pytest

from tests.proof.rows import cases, check
from tests.tables import table

# Other tables name the tests whose rows they hold.
TABLES = [
    path for path in sorted(Path(__file__).parent.rglob("*.yaml")) if type(table(path)) is list
]


@pytest.mark.parametrize(
    "case",
    [
        pytest.param(*case.values, id=f"{path.stem.removeprefix('test_')}-{case.id}")
        for path in TABLES
        for case in cases(str(path))
    ],
)
def test_what_a_row_says(case):
    check(case)
