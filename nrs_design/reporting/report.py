"""Build the report: its sections in reading order."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from nrs_design.certificates.certificate import canonical, to_document
from nrs_design.models.axis import axis_context
from nrs_design.reporting.document import Report
from nrs_design.reporting.evidence import evidence_sections
from nrs_design.reporting.remedies import remedies_section
from nrs_design.reporting.sections.design import design_sections
from nrs_design.reporting.sections.goals import goals_section
from nrs_design.reporting.sections.head import (
    claim_of,
    facts,
    key_facts,
    lights_of,
    proved_rate,
    summary_of,
)
from nrs_design.reporting.sections.mode_logic import logic_section
from nrs_design.reporting.sections.modes import modes_section
from nrs_design.reporting.sections.proof import proof_section
from nrs_design.reporting.sections.tail import (
    assumptions_section,
    recheck_section,
    rungs_section,
    spec_section,
)
from nrs_design.reporting.worst_case import worst_case_section

if TYPE_CHECKING:
    import datetime

    from nrs_design.design.analysis import DesignAnalysis
    from nrs_design.pipeline.blocked import Blocked
    from nrs_design.pipeline.certification import Result
    from nrs_design.pipeline.margins import ProofMargins


def build_report(
    result: Result,
    analysis: DesignAnalysis | None = None,
    *,
    margins: ProofMargins | None = None,
    blocked: Blocked | None = None,
    date: datetime.date | None = None,
) -> Report:
    """Build the report about one spec, with its figures drawn.

    Without an analysis it has no margins and no design figures.
    """
    with axis_context(getattr(result.loaded.spec, "axis", None)):
        spec, certification, designed = result.loaded.spec, result.certification, result.designed
        system = certification.system
        first = remedies_section(result, margins, blocked)
        others = (
            proof_section(result),
            *(design_sections(designed, analysis) if designed else ()),
            goals_section(result, analysis),
            logic_section(designed.spec) if designed else None,
            modes_section(result.loaded, system, proved_rate(system, certification.evidence)),
            *evidence_sections(certification),
            worst_case_section(result),
            assumptions_section(result),
            rungs_section(certification),
            recheck_section(result),
            spec_section(result.loaded),
        )
        sections = (first, *(replace(item, folded=True) for item in others if item is not None))
        return Report(
            name=spec.name,
            title=spec.title,
            verdict=str(certification.verdict),
            claim=claim_of(certification),
            remarks=tuple(
                statement.claim(system)
                for statement in certification.statements
                if statement is not certification.evidence
            ),
            facts=facts(result),
            sections=tuple(section for section in sections if section is not None),
            summary=summary_of(result),
            lights=lights_of(result, analysis),
            key=key_facts(result, analysis),
            lead="run",  # The run under the worst signal found, with its proved bound
            certificate=canonical(to_document(result.certificate)) if result.certificate else "",
            date=date,
        )
