"""Whether the spec of a run is proved."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from nrs_design.certificates.verify import verify
from nrs_design.errors import CertificateError
from nrs_design.proof.evidence import Shows

if TYPE_CHECKING:
    from nrs_design.spec import LoadedSpec


def proof_of(certificate: Path | None, loaded: LoadedSpec) -> tuple[str, bool]:
    """Say why the spec is not proved, and whether a proof holds while contact is lost.

    The reason is empty if the certificate proves it; one that is rejected is a `CertificateError`.
    """
    if certificate is None:
        return "no certificate is named", False
    outcome = verify(certificate, loaded)
    if outcome.certificate is None or outcome.fault is not None:
        raise CertificateError(
            f"the certificate is rejected: {outcome.fault}",
            path=certificate,
            remedy="make it anew with certify-switching --out, or name the spec that it is for",
        )
    verdict, statements = outcome.certificate.verdict, outcome.certificate.statements
    if verdict != "proved":
        return f"its certificate says {verdict}", False
    # A proof of a spec that asks for it holds while contact is lost, whatever its evidence.
    asked = loaded.spec.kind == "interaction-design" and loaded.spec.contact == "losable"
    covered = any(s.shows is Shows.STABILITY and s.covers_lost_contact for s in statements)
    return "", asked or covered
