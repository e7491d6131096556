"""What all documents about one outcome have in common."""

import pytest

from nrs_design.gating.formats import FORMATS


@pytest.mark.parametrize("name", FORMATS)
def test_equal_outcomes_give_equal_documents(mixed, name):
    assert FORMATS[name](mixed) == FORMATS[name](mixed)
    assert FORMATS[name](mixed).endswith("\n")
