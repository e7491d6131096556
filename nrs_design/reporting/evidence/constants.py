"""Evidence for several constant parameters: forms at the corners of their ranges, and a run."""

from __future__ import annotations

from dataclasses import replace

from nrs_design.proof.evidence import AbstractEvidence
from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.reporting.document import Paragraph, Section
from nrs_design.reporting.evidence import words
from nrs_design.reporting.evidence.norms import matrix_tables
from nrs_design.reporting.evidence.offers import Offer
from nrs_design.reporting.evidence.page import Page
from nrs_design.reporting.evidence.runs import Greedy, bounded_run, trials_per_step
from nrs_design.reporting.sections.modes import hardest_modes
from nrs_design.reporting.sections.titles import EVIDENCE
from nrs_design.simulation.norms import modes_at_corner, quadratic_norm, scaled_matrices
from nrs_design.simulation.switched import mode_rates, worst_direction

_CONSTANT = (
    "These parameters must be constant: one value each in all modes and at all times. Which "
    "values, need not be known. With two more matrices for each mode the condition is affine in "
    "what depends on them, so the corners of their ranges decide for all values between."
)
_TEXT = (
    "The certificate holds P at the corners of the constant parameters, and two more matrices for "
    "each mode, which are not shown. They are written with denominator 2^{}; here all P are "
    "divided by the largest entry."
)


def constants_page(system: SwitchedSystem, evidence: AbstractEvidence, offer: Offer) -> Page:
    """Return the page of P at every corner of the constant parameters, with free switching."""
    which = "Which norm |x| is, depends on the values of the constant parameters."
    text = Paragraph(_TEXT.format(offer.denominator_log2))
    return Page(
        "quadratic function of constant parameters",
        (
            f"{words.free_bound(system)} {which}",
            _CONSTANT,
            *words.unneeded_rules(system),
            words.decision(system),
        ),
        ("A constant parameter that changes while the system moves, however slowly.",),
        lambda: _run(system, evidence, offer),
        lambda: (Section(EVIDENCE, (text, *matrix_tables(offer.forms, system.states))),),
        "however fast they change, the constant ones excepted",
    )


def _run(system: SwitchedSystem, evidence: AbstractEvidence, offer: Offer) -> Section:
    """Draw a run at the corner where the decay is slowest."""
    forms = scaled_matrices(*(form.Q for form in offer.forms))
    corners = [modes_at_corner(system, k) for k in range(len(forms))]
    slowest = max if system.time is Time.DISCRETE else min
    rates = [slowest(mode_rates(at, P)) for at, P in zip(corners, forms, strict=True)]
    k = rates.index(slowest(rates))
    fixed, P = corners[k], forms[k]
    hardest = replace(hardest_modes(fixed, P, trials_per_step(fixed)), contact=None)
    proved = evidence.proved_rate(system)
    assert proved is not None  # it shows stability
    return bounded_run(
        Greedy(fixed, hardest, quadratic_norm(P), worst_direction(hardest, P), float(proved)),
        "in the norm of P at this corner",
        f"The constant parameters stay at corner {k + 1}, where the decay is slowest.",
    )
