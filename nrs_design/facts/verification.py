"""The re-check of a certificate."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from nrs_design.certificates.catalogue import sentences

if TYPE_CHECKING:
    from nrs_design.certificates.verify import Verification


def verification_facts(
    outcome: Verification, certificate: Path | None, spec: Path | None
) -> dict[str, Any]:
    """Return why a certificate is rejected, or what it shows."""
    from nrs_design.certificates.units import gain_units

    checked = outcome.certificate if outcome.fault is None else None
    compared = checked if spec is not None else None
    return {
        "verdict": checked.verdict if checked else "rejected",
        "refuted_in": checked.refuted_in if checked else None,
        "fault": outcome.fault,
        "claims": [item.claim(checked.system) for item in checked.statements] if checked else None,
        "gains": dict(compared.gains) if compared else None,
        "gain_units": gain_units(compared) if compared else None,
        "assumptions": list(sentences(compared.granted)) if compared else None,
        "certificate": None if certificate is None else str(certificate),
        "certificate_id": checked.id if checked else None,
        "spec": None if spec is None else str(spec),
    }
