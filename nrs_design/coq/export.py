"""Statement and certificate for the proof assistant Coq (or Rocq), in one file."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from nrs_design.certificates.catalogue import sentences
from nrs_design.certificates.certificate import Certificate
from nrs_design.coq.flows import flows_theorem
from nrs_design.coq.places import places_theorem
from nrs_design.coq.sampled import sampled_theorem
from nrs_design.coq.text import Theorem, in_comment
from nrs_design.errors import DesignError
from nrs_design.exporters import Format
from nrs_design.exporters.export import Export
from nrs_design.exporters.record import header_lines
from nrs_design.proof.evidence.graph import FormsOnGraph
from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem

# First bytes of a file, which a new one may replace.
COQ = b"(* nrs-design proof for Coq"
FORMAT = Format(
    "statement and certificate for the proof assistant Coq, which checks them by itself",
    "a proof of stability; matrices have one, too",
    {".v": COQ},
    identifier=True,
    needs_proof_only=True,
)
_LIBRARY = Path(__file__).parent
# Parts of a claim outside every theorem of the library.
_LEFT_OUT = (
    "that these modes are those of the robot: what is taken for granted, below",
    "that they come from the spec: `nrs-design verify CERTIFICATE SPEC` assembles them again",
)

_COVERED = (
    "lmi, gradient, conewise-quadratic and mode-quadratic; "
    "conewise-mode-quadratic in discrete time; polynomial and conewise-polynomial in continuous "
    "time"
)


def render(export: Export) -> dict[str, bytes]:
    """Return the file, by its ending; a `DesignError` where the library has no theorem."""
    certificate = export.certificate
    assert certificate is not None, "what is proved has a certificate"
    theorem = _choose_theorem(certificate)
    lines = _head_lines(export, certificate, theorem)
    head = "\n".join(f"   {in_comment(line)}" for line in lines)
    parts = [
        f"{COQ.decode()}\n{head} *)\n",
        *((_LIBRARY / f"{name}.v").read_text(encoding="utf-8") for name in theorem.library),
        "(** * The system, and what proves its stability *)\n",
        "Open Scope Z_scope.\n",
        *theorem.definitions,
        f"Lemma checked : {theorem.check} = true.\nProof. vm_cast_no_check (eq_refl true). Qed.\n",
        f"Theorem stable :\n  {theorem.statement}.\nProof. exact ({theorem.proof}). Qed.\n",
        "Print Assumptions stable.\n",
    ]
    return {".v": "\n".join(parts).encode()}


def _head_lines(export: Export, certificate: Certificate, theorem: Theorem) -> Iterator[str]:
    yield "to check it: coqc and the name of this file; the last lines print what it assumes"
    if export.record is not None:
        yield from header_lines(export.record)
    else:
        evidence = certificate.evidence
        assert evidence is not None, "it is proved"
        yield f"spec: {certificate.spec_name}, sha256 {certificate.spec_sha256}"
        yield f"certificate: {certificate.id}"
        yield f"claim: {evidence.claim(certificate.system)}"
    yield f"states, in this order: {', '.join(theorem.states)}"
    yield from (f"not in the theorem: {text}" for text in (*theorem.left_out, *_LEFT_OUT))
    yield from (f"taken for granted: {text}" for text in sentences(certificate.granted))


def _choose_theorem(certificate: Certificate) -> Theorem:
    """Return the theorem of a certificate; a `DesignError` if the library for Coq has none."""
    system, evidence = certificate.system, certificate.evidence
    if not isinstance(evidence, FormsOnGraph):
        kind = "nothing" if evidence is None else f"kind {evidence.kind}"
        raise _refused(f"stability is shown by {kind}")
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
        remedy=f"there is one for {_COVERED}",
    )
