"""What is taken for granted, and what was tried."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nrs_design.reporting.document import Bullets, Section, Table

if TYPE_CHECKING:
    from nrs_design.certificates.certify import Certification


def assumptions_section(certification: Certification) -> Section:
    """List what a statement about the matrices takes for granted."""
    return Section("Assumptions", (Bullets("", certification.system.assumptions),))


def search_section(certification: Certification) -> Section:
    """List the steps of the search; times are left out, they differ from run to run."""
    rows = tuple((attempt.step, attempt.outcome) for attempt in certification.attempts)
    return Section("Search", (Table("Steps in the order tried", ("Step", "Outcome"), rows),))
