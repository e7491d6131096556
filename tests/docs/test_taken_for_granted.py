"""The page of assumptions is made from the table that certificates are said from."""

from making.assumptions import assumptions_table

from nrs_design.certificates.catalogue import kinds
from tests.support import ROOT


def test_the_page_lists_every_kind_that_takes_something_for_granted():
    page = (ROOT / "docs/certificates/taken-for-granted.md").read_text(encoding="utf-8")
    assert "<!-- made: assumptions -->" in page
    rows = assumptions_table().splitlines()[2:]
    assert len(rows) == len(kinds()) - 1
    assert any(row.startswith("| what is touched does not load the motor |") for row in rows)
