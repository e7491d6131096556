"""Every error of the print has a row, and counts once."""

import pytest

from nrs_design.thesis import formulas
from nrs_design.thesis.comparison import PrintVerdict
from nrs_design.thesis.errata import errata
from nrs_design.thesis.formulas import CHECKS
from nrs_design.thesis.table import topic_rows


def test_every_erratum_has_a_row_and_every_row_a_known_erratum(rows):
    touched = {one for row in rows for one in row.errata}
    assert touched == {one.id for one in errata()}


def test_what_is_printed_differently_names_its_error(rows):
    wrong = [row for row in rows if row.verdict is PrintVerdict.PRINTED_DIFFERENTLY]
    assert [row.name for row in wrong if not row.errata] == []


@pytest.mark.parametrize("name", CHECKS)
def test_a_formula_that_no_longer_holds_is_a_drift(name, monkeypatch):
    monkeypatch.setattr(formulas, "CHECKS", {**CHECKS, name: lambda: False})
    drifts = [row for row in topic_rows("formulas") if row.verdict is PrintVerdict.DRIFT]
    assert len(drifts) == 1
    assert name in drifts[0].section


def test_the_checks_tell_the_print_from_what_is_right(monkeypatch):
    """With another power in 2.15, other arms in 4.18 and another sign in 6.21 they fail."""
    monkeypatch.setattr(formulas.thesis, "SETTLING_TIME", 0.2)
    assert not CHECKS["4.25"]()
    monkeypatch.setattr(formulas.thesis, "DAMPING_RATIO", 0.5)
    assert not CHECKS["4.24"]()
    monkeypatch.setattr(formulas, "printed_rows", lambda *entries: [[-1]])
    assert not CHECKS["5.18"]()
    monkeypatch.setattr(formulas, "impedance_rows", lambda *given: [[-1, 0, 0, 0]] * 4)
    assert not CHECKS["6.21"]()
