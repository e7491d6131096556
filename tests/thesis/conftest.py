"""The whole table, recomputed once."""

import pytest

from nrs_design.thesis.table import reproduce


@pytest.fixture(scope="session")
def rows():
    return reproduce()
