"""The page of one statement, chosen by what it shows and what it offers, never by its kind."""

from __future__ import annotations

from nrs_design.proof.evidence import AbstractEvidence, Shows
from nrs_design.proof.system import SwitchedSystem
from nrs_design.reporting.evidence.blocks import blocks_page
from nrs_design.reporting.evidence.functions import constants_page, functions_page
from nrs_design.reporting.evidence.growth import growth_page, obstruction_page
from nrs_design.reporting.evidence.offers import Page, offer_of
from nrs_design.reporting.evidence.regions import bound_page, saturation_page

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
