"""What is not modelled together: the page has every row of the table."""

from making.combinations import combinations_table

from nrs_design.spec.combinations import COMBINATIONS


def test_the_page_has_every_row_with_its_names_filled():
    _, _, *rows = combinations_table().splitlines()
    assert len(rows) == len(COMBINATIONS)
    assert all(row.count(" | ") == 3 for row in rows)
    assert "{0" not in "".join(rows)
    page = "\n".join(rows)
    assert "| the offset of X | `controllers.X.offset` | a mixture of controllers |" in page
    assert "add `sampling: {period: 2 ms, delay: 0}`" in page
