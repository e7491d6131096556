"""Why no common quadratic function exists: the weights of the contradiction."""

from __future__ import annotations

from functools import partial

from nrs_design.proof.evidence import AbstractEvidence
from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.reporting.document import Paragraph, Section, Table
from nrs_design.reporting.evidence.offers import Offer
from nrs_design.reporting.evidence.page import Page
from nrs_design.reporting.evidence.runs import unbounded_run
from nrs_design.reporting.formatting import number

_LISTED = 24
_MEANING = (
    "That no common quadratic function exists says nothing about stability: a function of another "
    "kind may exist."
)
_ARGUMENT = (
    "The certificate holds a positive semidefinite matrix X for some modes, such that the sum S of "
    "{} over them is positive definite. If some Q > 0 decreased in every mode, then the trace of "
    "Q S would be positive, and equal to the sum of the traces of X ({}), which is at most zero: a "
    "contradiction. A search for a common quadratic function can stop."
)
_TERMS = {
    Time.CONTINUOUS: ("A X + X A'", "A'Q + QA"),
    Time.DISCRETE: ("A X A' - X", "A'QA - Q"),
}


def obstruction_page(system: SwitchedSystem, _: AbstractEvidence, offer: Offer) -> Page:
    """Return the argument, and the modes that contradict each other."""
    return Page(
        "no common quadratic function exists",
        (_MEANING,),
        (),
        partial(unbounded_run, system),
        lambda: (_section(system, offer),),
    )


def _section(system: SwitchedSystem, offer: Offer) -> Section:
    """Say why there is none, and which modes contradict each other."""
    text = f"{_ARGUMENT.format(*_TERMS[system.time])} {_MEANING}"
    weights = offer.weights
    rows = tuple((name, number(float(share), 4)) for name, share in weights[:_LISTED])
    some = f", the {_LISTED} heaviest" if len(weights) > _LISTED else ""
    left_out = len(system.modes) - len(weights)
    none = f"; {left_out} modes have no part in it" if left_out else ""
    title = f"Weight of the modes in the contradiction{some}{none}"
    table = Table(title, ("Mode", "Share of the trace of X [1]"), rows)
    return Section("No common quadratic function", (Paragraph(text), table))
