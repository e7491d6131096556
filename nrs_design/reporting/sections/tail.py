"""What is taken for granted, and what was tried."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nrs_design.reporting.document import Bullets, Section, Table
from nrs_design.reporting.formatting import number

if TYPE_CHECKING:
    from nrs_design.search.certification import Certification


def assumptions_section(certification: Certification) -> Section:
    """List what a statement about the matrices takes for granted."""
    return Section("Assumptions", (Bullets("", certification.system.assumptions),))


def rungs_section(certification: Certification, *, times: bool) -> Section:
    """List every rung of the search with its outcome.

    Parameters
    ----------
    certification : Certification
        With its attempts.
    times : bool
        Add how long each took; that differs from run to run.
    """
    columns = ("Rung", "Outcome", "Time [ms]") if times else ("Rung", "Outcome")
    rows = tuple(
        (attempt.step, attempt.outcome, number(1e3 * attempt.seconds, 3))[: len(columns)]
        for attempt in certification.attempts
    )
    return Section("Rungs tried", (Table("In the order tried", columns, rows),))
