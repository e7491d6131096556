"""Put the report together: what it says, in reading order."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nrs_design.reporting.document import Report
from nrs_design.reporting.sections.proof import claim_of, facts, proof_section, recheck_section
from nrs_design.reporting.sections.search import assumptions_section, search_section

if TYPE_CHECKING:
    from nrs_design.design.evidence import DesignEvidence
    from nrs_design.pipeline import Result


def build_report(result: Result, evidence: DesignEvidence | None = None) -> Report:
    """Say and draw everything about one spec.

    Parameters
    ----------
    result : Result
        As `nrs_design.pipeline.run_certification` gives it.
    evidence : DesignEvidence, optional
        As `nrs_design.pipeline.run_evidence` gives it. Without it the report has no margins and
        no design figures.
    """
    spec, certification = result.loaded.spec, result.certification
    return Report(
        name=spec.name,
        title=spec.title,
        verdict=str(certification.verdict),
        claim=claim_of(certification),
        facts=facts(result),
        sections=(
            proof_section(result),
            assumptions_section(certification),
            search_section(certification),
            recheck_section(result),
        ),
    )
