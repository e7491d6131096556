"""Pages that are made from a table have every row of it."""

from making.assumptions import assumptions_table
from making.combinations import combinations_table

from nrs_design.certificates.catalogue import kinds
from nrs_design.spec.combinations import COMBINATIONS
from tests.docs.pages import text_of


def test_the_page_has_every_row_with_its_names_filled():
    _, _, *rows = combinations_table().splitlines()
    assert len(rows) == len(COMBINATIONS)
    assert all(row.count(" | ") == 3 for row in rows)
    assert "{0" not in "".join(rows)
    page = "\n".join(rows)
    assert "| the offset of X | `controllers.X.offset` | a mixture of controllers |" in page
    assert "add `sampling: {period: 2 ms, delay: 0}`" in page


def test_the_page_lists_every_kind_that_takes_something_for_granted():
    page = text_of("docs/certificates/taken-for-granted.md")
    assert "<!-- made: assumptions -->" in page
    rows = assumptions_table().splitlines()[2:]
    assert len(rows) == len(kinds()) - 1
    assert any(row.startswith("| what is touched does not load the motor |") for row in rows)
