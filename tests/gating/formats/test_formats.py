"""What all documents about one outcome have in common."""

import pytest

from nrs_design.gating.formats import FORMATS


def test_worst_comes_first(mixed):
    order = [str(item.status) for item in mixed.broken]
    assert order == ["error", "error", "refuted", "missed", "inconclusive"]
    assert mixed.broken[0].rule.id == "NRS900"


@pytest.mark.parametrize("name", FORMATS)
def test_equal_outcomes_give_equal_documents(mixed, name):
    assert FORMATS[name](mixed) == FORMATS[name](mixed)
    assert FORMATS[name](mixed).endswith("\n")
