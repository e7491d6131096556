"""Systems that contradict themselves, and others: the rows of test_contradiction.yaml."""

import pytest

from tests.proof.rows import cases, check


@pytest.mark.parametrize("case", cases(__file__))
def test_what_a_row_says(case):
    check(case)
