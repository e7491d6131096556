"""Ellipsoids: how far a disturbance pushes an output, or from where saturating signals decay."""

from __future__ import annotations

from nrs_design.proof.bounds import lower, nearly, rounded_down, rounded_up
from nrs_design.proof.evidence import AbstractEvidence
from nrs_design.proof.evidence.abstract import Bound
from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.reporting.document import Block, Paragraph, Section, Table
from nrs_design.reporting.evidence import words
from nrs_design.reporting.evidence.functions import matrix_tables
from nrs_design.reporting.evidence.offers import Offer, Page
from nrs_design.reporting.formatting import number
from nrs_design.reporting.sections.titles import SATURATION

_BOUND = (
    "From rest, the state does not leave the set V = w' Q w <= 1 while the disturbance keeps its "
    "bound, however it changes; from any other state, V comes down to 1."
)
_SATURATED = (
    "Wherever V = w' Q w <= 1, each signal is a mixture of its argument and of h w, which keeps "
    "its limit there; so the loop moves as a mixture of linear ones, in all of which V decreases. "
    "A higher limit leaves it such a mixture."
)
_CONTENT = (
    "The certificate holds the matrix Q, one row h for each signal, the rate and the size of the "
    "start. Here Q is scaled."
)


def bound_page(system: SwitchedSystem, evidence: AbstractEvidence, _: Offer) -> Page:
    """Return the level that an output does not exceed."""
    bound = evidence.bound(system)
    assert bound is not None, "bound evidence has a bound"
    limits = ("What happens between two steps.",) if system.time is Time.DISCRETE else ()
    return Page(
        "bound on an output under a disturbance",
        (_BOUND, *words.unneeded_rules(system), words.decision(system)),
        (
            "Other disturbances beside those named, and larger ones.",
            "That the bound is reached: the largest possible value may be smaller.",
            *limits,
        ),
        sections=lambda: (_bound_section(system, bound),),
    )


def _bound_section(system: SwitchedSystem, bound: Bound) -> Section:
    """Show the level, the disturbances and the limit of the spec."""
    output, unit = bound.output, bound.output.unit
    rows = [
        ("Disturbance", f"|{item.name}| <= {rounded_down(item.bound, item.unit)}")
        for item in bound.channels
    ]
    rows.append((f"|{output.name}|, proved never to exceed", rounded_up(bound.level, unit)))
    if output.limit is not None:
        rows.append(("Limit of the spec", nearly(output.limit, unit)))
    per = "per step" if system.time is Time.DISCRETE else "1/s"
    text = (
        f"The certificate holds Q and the share a = {number(float(bound.share), 4)} {per}: V grows "
        "by at most a times 1 - V."
    )
    has_all_channels = len(bound.channels) == len(system.channels) > 1
    names = ", ".join(item.name for item in bound.channels)
    title = (
        f"Bound on {output.name} under {'all disturbances at once' if has_all_channels else names}"
    )
    table = Table("Bound and limit", ("Quantity", "Value"), tuple(rows))
    return Section(title, (Paragraph(text), table))


def saturation_page(system: SwitchedSystem, evidence: AbstractEvidence, offer: Offer) -> Page:
    """Return the limits, the start and Q."""
    assert system.saturation is not None  # the evidence is about it
    start = system.saturation.start.name
    return Page(
        "decay from an ellipsoid although signals saturate",
        (_SATURATED, *words.unneeded_rules(system), words.decision(system)),
        (
            "Motions that begin outside of the ellipsoid: they may decay as well.",
            "Commands of a hand and disturbances while signals saturate.",
            f"That the {start} is within the limit of a spec: motions may begin beyond it.",
            "Lower limits, and other signals that saturate, such as the current of the motor.",
        ),
        sections=lambda: (_saturation_section(system, evidence, offer),),
    )


def _saturation_section(
    system: SwitchedSystem, evidence: AbstractEvidence, offer: Offer
) -> Section:
    """Show limits, start and matrix."""
    saturation, level, rate = system.saturation, evidence.start_size, evidence.start_rate(system)
    assert saturation is not None
    assert level is not None  # it shows both
    assert rate is not None
    start = saturation.start
    name, unit = start.name.capitalize(), start.unit
    # The claim holds for this limit and higher ones, so round up.
    rows = [(f"Limit of the {s.name}", rounded_up(s.limit, s.unit)) for s in saturation.signals]
    rows.append((f"{name} at rest, proved", rounded_down(level, unit)))
    if start.wanted is not None:
        rows.append((f"{name} that is wanted", nearly(start.wanted, unit)))
    rows.append(("Rate of decay, proved", f"{lower(rate)} 1/s"))
    blocks: tuple[Block, ...] = (
        Paragraph(_CONTENT),
        Table("Decay although signals saturate", ("Quantity", "Value"), tuple(rows)),
        *matrix_tables(offer.forms, system.states),
    )
    return Section(SATURATION, blocks)
