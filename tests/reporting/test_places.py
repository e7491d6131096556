"""Numbers of a report lead to the lines of the spec that they come from."""

import re

import pytest

from nrs_design.certificates.catalogue import kinds
from nrs_design.reporting.document import Linked, Table
from nrs_design.reporting.sections.places import (
    linked,
    locate_assumption,
    locate_contact,
    locate_mode,
)
from nrs_design.spec import read_spec
from tests.support import COMMUTING, SOFT_TISSUE
from tests.tables import rows


def lines_of(report, section, column):
    """Return the text of the lines that a column of the first table of a section leads to."""
    found = next(part for part in report.sections if part.title == section)
    table = next(block for block in found.blocks if isinstance(block, Table))
    listing = SOFT_TISSUE.read_text(encoding="utf-8").splitlines()
    cells = [row[column] for row in table.rows if row[column] not in ("", "–")]
    assert all(isinstance(cell, Linked) for cell in cells if re.search(r"[0-9]", cell)), cells
    return {listing[cell.line - 1].strip() for cell in cells if isinstance(cell, Linked)}


@pytest.mark.parametrize(
    ("section", "column", "expected"), rows(__file__, "test_numbers_lead_to_their_lines")
)
def test_numbers_lead_to_their_lines(report, section, column, expected):
    assert lines_of(report("proved"), section, column) == set(expected)


def test_the_motion_loop_leads_to_what_is_asked_for(report):
    said = lines_of(report("proved"), "Motion loop", 2)
    keys = {line.split(":")[0] for line in said}
    assert keys == {"derivative_gain", "zero", "settling_time", "damping_ratio"}


def test_what_a_spec_does_not_say_leads_nowhere():
    loaded = read_spec(SOFT_TISSUE)
    assert not isinstance(linked(loaded, "1", "disturbances"), Linked)
    assert not isinstance(linked(loaded, "–", "limits"), Linked)
    assert not isinstance(linked(loaded, "1"), Linked)
    assert isinstance(linked(loaded, "1", "limits", "torque"), Linked)
    assert locate_assumption(kinds()["not-sampled"]) == ()
    assert locate_assumption(kinds()["load"]) == ("actuator", "load_inertia")


def test_a_mode_leads_to_its_matrix_or_its_controller():
    given, design = read_spec(COMMUTING), read_spec(SOFT_TISSUE)
    second = given.spec.modes[1].name
    assert locate_mode(given, f"{second}/k-min") == ("modes", 1)
    assert locate_mode(design, "withdrawal/soft/k-min") == ("controllers", "withdrawal")
    assert locate_contact(design, "withdrawal/soft/k-min") == ("environments", "soft")
    assert locate_contact(given, "anything") == ()
