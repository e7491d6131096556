"""The page of one statement, chosen by what it shows and what it offers, never by its kind."""

from __future__ import annotations

from collections.abc import Mapping

from nrs_design.proof.evidence import AbstractEvidence, Shows
from nrs_design.proof.system import SwitchedSystem
from nrs_design.reporting.evidence.blocks import BlocksPage
from nrs_design.reporting.evidence.bound import BoundPage
from nrs_design.reporting.evidence.constants import ConstantsPage
from nrs_design.reporting.evidence.functions import FunctionsPage
from nrs_design.reporting.evidence.growth import GrowthPage
from nrs_design.reporting.evidence.obstruction import ObstructionPage
from nrs_design.reporting.evidence.offers import offer_of
from nrs_design.reporting.evidence.page import AbstractPage
from nrs_design.reporting.evidence.saturation import SaturationPage

_PAGES: Mapping[Shows, type[AbstractPage]] = {
    Shows.STABILITY: FunctionsPage,
    Shows.INSTABILITY: GrowthPage,
    Shows.NO_COMMON_QUADRATIC: ObstructionPage,
    Shows.BOUND: BoundPage,
    Shows.REGION: SaturationPage,
}


def page_of(system: SwitchedSystem, evidence: AbstractEvidence) -> AbstractPage:
    """Return the page of a statement about a system."""
    offer = offer_of(evidence)
    if offer.blocks:
        return BlocksPage(system, evidence, offer, page_of)
    if any(form.corner is not None for form in offer.forms):
        return ConstantsPage(system, evidence, offer)
    return _PAGES[evidence.shows](system, evidence, offer)
