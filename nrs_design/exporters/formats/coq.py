"""Statement and certificate for the proof assistant Coq (or Rocq), in one file."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from nrs_design.certificates.catalogue import sentences
from nrs_design.certificates.certificate import Certificate
from nrs_design.exporters import Format
from nrs_design.exporters.export import Export
from nrs_design.exporters.proof_assistant import choose_theorem
from nrs_design.exporters.proof_assistant.text import Theorem, in_comment
from nrs_design.exporters.record import header_lines
from nrs_design.output import COQ

FORMAT = Format(
    "statement and certificate for the proof assistant Coq, which checks them by itself",
    "a proof of stability; matrices have one, too",
    {".v": COQ},
    identifier=True,
    alone=True,
)
_LIBRARY = Path(__file__).parent.parent / "proof_assistant"
# What no statement of the library covers of a claim.
_LEFT_OUT = (
    "that these modes are those of the robot: what is taken for granted, below",
    "that they come from the spec: `nrs-design verify CERTIFICATE SPEC` assembles them again",
)


def render(export: Export) -> dict[str, bytes]:
    """Return the file, by its ending; a `DesignError` where the library has no theorem."""
    certificate = export.certificate
    assert certificate is not None, "what is proved has a certificate"
    theorem = choose_theorem(certificate)
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
