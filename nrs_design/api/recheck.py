"""The re-check of a certificate file, as the library gives it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from nrs_design.api.result import AbstractResult, Figures, evidence_drawings
from nrs_design.certificates.catalogue import sentences
from nrs_design.certificates.certificate import Certificate
from nrs_design.certificates.prove import Verification
from nrs_design.certificates.verify import verify as verify_file
from nrs_design.models.axis import find_axis
from nrs_design.pipeline.certification import recorded_certification
from nrs_design.spec import read_spec


@dataclass(frozen=True, repr=False)
class Recheck(AbstractResult):
    """What a re-check says of a certificate."""

    file: Path  # The certificate
    spec: Path | None  # Spec of the comparison
    outcome: Verification

    @property
    def fault(self) -> str | None:
        """Reason for rejection; None for a valid certificate."""
        return self.outcome.fault

    @property
    def certificate(self) -> Certificate | None:
        """Certificate in the file; a proof or a refutation if valid."""
        return self.outcome.certificate

    @property
    def verdict(self) -> str:
        """``rejected``; of a valid certificate, what it shows."""
        certificate = self._valid()
        return "rejected" if certificate is None else certificate.verdict

    @property
    def claims(self) -> tuple[str, ...]:
        """Claims in words; empty for a rejected certificate."""
        certificate = self._valid()
        return (
            ()
            if certificate is None
            else tuple(s.claim(certificate.system) for s in certificate.statements)
        )

    def _axis(self) -> object:
        return None if self.certificate is None else find_axis(self.certificate.system.states)

    def _facts(self) -> dict[str, Any]:
        from nrs_design.certificates.units import gain_units

        certificate = self._valid()
        compared = certificate if self.spec is not None else None
        return {
            "verdict": self.verdict,
            "refuted_in": certificate.refuted_in if certificate else None,
            "fault": self.fault,
            "claims": None if certificate is None else list(self.claims),
            "gains": dict(compared.gains) if compared else None,
            "gain_units": gain_units(compared) if compared else None,
            "assumptions": list(sentences(compared.granted)) if compared else None,
            "certificate": str(self.file),
            "certificate_id": certificate.id if certificate else None,
            "spec": None if self.spec is None else str(self.spec),
        }

    def _valid(self) -> Certificate | None:
        return self.certificate if self.fault is None else None

    def _drawings(self) -> Figures:
        kept = self._valid()
        if kept is None:
            return []
        return evidence_drawings(recorded_certification(kept, self.file))

    def _headline(self) -> str:
        spec_note = "" if self.spec is None else f" for {self.spec.name}"
        return f"{self.file.name}{spec_note}: {self.verdict}"

    def _rows(self) -> Iterator[Sequence[str]]:
        yield "", ""
        if self.fault is not None:
            yield "fault", self.fault
        for claim in self.claims:
            yield "claim", claim

    def __bool__(self) -> bool:
        """Return True for a valid proof; a valid refutation gives False."""
        return bool(self.outcome)


def verify(certificate: str | Path, spec: str | Path | None = None) -> Recheck:
    """Re-check a certificate file, exactly and without a solver.

    Parameters
    ----------
    certificate : path-like
        The file.
    spec : path-like, optional
        The spec that it must belong to. Without it the proof is checked for the modes that the
        file holds, whosever they are.

    Returns
    -------
    Recheck
        Its `fault` says why the certificate is rejected, None if it is valid. Its
        `verdict` may be ``refuted``; true in a condition if it is a proof. What cannot be read at
        all raises a SpecError or CertificateError.
    """
    file, against = Path(certificate), None if spec is None else Path(spec)
    loaded = None if against is None else read_spec(against)
    return Recheck(file, against, verify_file(file, loaded))
