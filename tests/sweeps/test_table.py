"""Documents of points as columns of a table."""

from nrs_design.sweeps.table import cell_text, fact_columns, flat


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
    columns = fact_columns(iter(rows))
    assert columns.every == ("same", "rate", "said", "rate_exact", "late")
    assert columns.telling == ("rate", "late")
    assert fact_columns([]).every == ()


def test_cells():
    assert [cell_text(value) for value in (None, True, False, 1 / 3, 7, "a")] == [
        "-",
        "yes",
        "no",
        "0.333333",
        "7",
        "a",
    ]
