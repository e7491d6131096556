"""Pages of statements, chosen by conclusion and offer, never by kind."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from nrs_design.proof.evidence import AbstractEvidence, Shows
from nrs_design.proof.system import SwitchedSystem
from nrs_design.reporting.document import Paragraph, Section
from nrs_design.reporting.evidence.blocks import blocks_page
from nrs_design.reporting.evidence.functions import constants_page, functions_page
from nrs_design.reporting.evidence.growth import growth_page, obstruction_page
from nrs_design.reporting.evidence.offers import Page, offer_of
from nrs_design.reporting.evidence.regions import bound_page, saturation_page
from nrs_design.reporting.evidence.runs import unbounded_run
from nrs_design.search.certification import Certification

_LINEAR = "Nothing is cut off at a limit in this run, as if no signal ever saturated."

_PAGES = {
    Shows.STABILITY: functions_page,
    Shows.INSTABILITY: growth_page,
    Shows.NO_COMMON_QUADRATIC: obstruction_page,
    Shows.BOUND: bound_page,
    Shows.REGION: saturation_page,
}


def page_of(system: SwitchedSystem, evidence: AbstractEvidence) -> Page:
    """Return the page of a statement about a system."""
    offer = offer_of(evidence)
    if offer.blocks:
        return blocks_page(system, evidence, offer, page_of)
    if any(form.corner is not None for form in offer.forms):
        return constants_page(system, evidence, offer)
    return _PAGES[evidence.shows](system, evidence, offer)


def evidence_sections(certification: Certification) -> Iterator[Section]:
    """Yield a section for every statement, and one with a run."""
    system, evidence = certification.system, certification.evidence
    for statement in certification.statements:
        yield from page_of(system, statement).sections()
    draw_run = None if evidence is None else page_of(system, evidence).run
    run = unbounded_run(system) if draw_run is None else draw_run()
    if system.saturation is not None:
        run = replace(run, blocks=(Paragraph(_LINEAR), *run.blocks))
    yield run
