"""Put the report together: what it says, in reading order."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nrs_design.certificates.evidence import CommonQuadratic
from nrs_design.reporting.document import Report, Section
from nrs_design.reporting.sections.design import design_sections
from nrs_design.reporting.sections.modes import lyapunov_section, modes_section
from nrs_design.reporting.sections.proof import claim_of, facts, proof_section, recheck_section
from nrs_design.reporting.sections.run import run_section
from nrs_design.reporting.sections.search import assumptions_section, search_section
from nrs_design.spec import InteractionDesignSpec

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

    Returns
    -------
    Report
        With its figures drawn; `render_html`, `render_pdf` and `render_png` write it out.
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
            *_design(result, evidence),
            *_system(result),
            assumptions_section(certification),
            search_section(certification),
            recheck_section(result),
        ),
    )


def _design(result: Result, evidence: DesignEvidence | None) -> tuple[Section, ...]:
    spec = result.loaded.spec
    if result.design is None or not isinstance(spec, InteractionDesignSpec):
        return ()
    return design_sections(spec, result.design, evidence)


def _system(result: Result) -> tuple[Section, ...]:
    system, evidence = result.certification.system, result.certification.evidence
    if isinstance(evidence, CommonQuadratic):
        modes = modes_section(system, float(evidence.rate))
        return (modes, lyapunov_section(system, evidence), run_section(system, evidence))
    return (modes_section(system, None), run_section(system, evidence))
