"""Documents of points as columns of a table."""

import pytest

from nrs_design.errors import NrsDesignError
from nrs_design.pipeline.sweep_table import cell_text, chosen, facts_in, flat, telling


def test_items_are_called_by_their_names():
    document = {
        "spec_sha256": "ab",
        "controllers": [{"name": "in", "Mt": 1.5}, {"name": "out", "Mt": None}],
        "modes": ["a", "b"],
        "empty": [],
    }
    assert dict(flat(document)) == {
        "controllers.in.Mt": 1.5,
        "controllers.out.Mt": None,
        "modes.0": "a",
        "modes.1": "b",
    }


def test_a_fact_tells_if_it_differs_and_is_short():
    rows = [
        {"same": 1, "rate": 0.1, "said": "a" * 30, "rate_exact": "1/10"},
        {"same": 1, "rate": 0.2, "said": "b" * 30, "rate_exact": "1/5", "late": 1},
        {"same": 1, "rate": 0.2, "late": 1},
    ]
    assert facts_in(rows) == ["same", "rate", "said", "rate_exact", "late"]
    assert telling(rows) == telling([*rows, {}]) == ["rate", "late"]


def test_facts_are_chosen_by_how_they_end():
    rows = [{"a.Mt": 1, "a.Bt": 2, "b.Bt": 3, "a.optimum.Bt": 4, "verdict": "proved"}]
    assert chosen(rows, ["Bt", "verdict", "a.Bt"]) == ["a.Bt", "b.Bt", "verdict"]
    with pytest.raises(NrsDesignError, match="no answer has a fact 'Bx'"):
        chosen(rows, ["Bx"])


def test_cells():
    assert [cell_text(value) for value in (None, True, False, 1 / 3, 7, "a")] == [
        "-",
        "yes",
        "no",
        "0.333333",
        "7",
        "a",
    ]
