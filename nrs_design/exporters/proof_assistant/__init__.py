"""Certificates as theorems of Coq: which have one, and of which part of the library beside it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from nrs_design.certificates.certificate import Certificate
from nrs_design.errors import DesignError
from nrs_design.exporters.proof_assistant.flows import flows_theorem
from nrs_design.exporters.proof_assistant.places import places_theorem
from nrs_design.exporters.proof_assistant.sampled import sampled_theorem
from nrs_design.exporters.proof_assistant.text import Theorem
from nrs_design.proof.evidence.graph import FormsOnGraph
from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem

COVERED = (
    "lmi, gradient, conewise-quadratic and mode-quadratic; "
    "conewise-mode-quadratic in discrete time; polynomial and conewise-polynomial in continuous "
    "time"
)


def choose_theorem(certificate: Certificate) -> Theorem:
    """Return the theorem of a certificate; a `DesignError` if the library for Coq has none."""
    system, evidence = certificate.system, certificate.evidence
    kind = "nothing" if evidence is None else evidence.kind
    if kind not in _BY_KIND:
        raise _refused(f"stability is shown by {kind if evidence is None else f'kind {kind}'}")
    return _BY_KIND[kind](system, evidence)


def _graph_theorem(system: SwitchedSystem, evidence: FormsOnGraph) -> Theorem:
    if (odd := _find_uncovered(system, evidence)) is not None:
        raise _refused(odd)
    if evidence.stays is not None:
        return places_theorem(system, evidence)
    if system.time is Time.CONTINUOUS:
        return flows_theorem(system, evidence)
    return sampled_theorem(system, evidence)


def _find_uncovered(system: SwitchedSystem, evidence: FormsOnGraph) -> str | None:
    contact = system.contact if evidence.covers_lost_contact else None
    if contact is not None and contact.pulls:
        return "its environment could pull where contact is lost"
    if system.clock is not None:
        return "its modes take turns, or miss deadlines"
    if any(edge.target is not None for edge in evidence.edges):
        return "its steps lead to some of the forms at a place only"
    if system.time is Time.CONTINUOUS:
        left = evidence.stays is not None and evidence.stays.leaving
        return "some of its modes must be left, in continuous time" if left else None
    if evidence.degree > 1:
        return "its forms are polynomials in discrete time"
    return None


def _refused(reason: str) -> DesignError:
    return DesignError(
        f"there is no theorem for Coq of this certificate: {reason}",
        remedy=f"there is one for {COVERED}",
    )


# What is written for a kind of evidence; others are refused.
_BY_KIND: Mapping[str, Callable[[SwitchedSystem, Any], Theorem]] = {
    "graph": _graph_theorem,
}
