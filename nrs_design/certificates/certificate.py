"""The certificate: what is claimed, and the numbers that prove it."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping
from enum import StrEnum
from typing import Any

from nrs_design.proof.evidence import AbstractEvidence, Shows
from nrs_design.proof.noun import dataclass
from nrs_design.proof.system import SwitchedSystem
from nrs_design.proof.system_fields import system_fields

SCHEMA = "nrs-design/certificate/4"
# It named the modes only; what they are had to be assembled from the spec.
FORMER = "nrs-design/certificate/3"
# What says nothing about the claim, so that the id does not cover it.
UNSIGNED = frozenset({"id", "origin"})

Gains = Mapping[str, Mapping[str, str]]


class Verdict(StrEnum):
    """What is known about uniform exponential stability under the declared switching."""

    PROVED = "proved"
    REFUTED = "refuted"
    INCONCLUSIVE = "inconclusive"


class CommonQuadraticStatus(StrEnum):
    """What is known about a common quadratic Lyapunov function."""

    EXISTS = "exists"
    IMPOSSIBLE = "impossible"
    UNKNOWN = "unknown"


@dataclass(frozen=True, slots=True)
class Certificate:
    """A claim about one spec with the evidence for it.

    Parameters
    ----------
    spec_name, spec_sha256 : str
        The spec that it belongs to, and the hash of what that file says.
    coordinates : str or None
        ``deflection`` or ``force`` for an interaction design, None for given matrices.
    gains : mapping
        Designed gains (float32, as exact decimals) by controller; empty for given matrices.
    system : SwitchedSystem
        What the statements are about.
    statements : tuple of AbstractEvidence
        What is shown, each with its numbers; at least one.
    version : str
        Version of this package.
    schema : str
        Of the file that it was read from; `FORMER` has no modes and no rules of switching.
    """

    spec_name: str
    spec_sha256: str
    coordinates: str | None
    gains: Gains
    system: SwitchedSystem
    statements: tuple[AbstractEvidence, ...]
    version: str
    schema: str = SCHEMA

    @property
    def verdict(self) -> str:
        """``proved``, ``refuted``, or ``inconclusive`` if it shows neither."""
        return str(verdict_of(self.statements))

    @property
    def evidence(self) -> AbstractEvidence | None:
        """The statement that decides the verdict, or None."""
        return deciding(self.statements)

    @property
    def common_quadratic(self) -> CommonQuadraticStatus:
        """What the statements say about a common quadratic function."""
        return common_quadratic_of(self.system, self.statements)

    @property
    def id(self) -> str:
        """SHA-256 over the canonical content."""
        return content_id(to_document(self))


def verdict_of(statements: Iterable[AbstractEvidence]) -> Verdict:
    """Return the verdict that checked statements carry."""
    shown = {statement.shows for statement in statements}
    if Shows.STABILITY in shown:
        return Verdict.PROVED
    return Verdict.REFUTED if Shows.INSTABILITY in shown else Verdict.INCONCLUSIVE


def deciding(statements: Iterable[AbstractEvidence]) -> AbstractEvidence | None:
    """Return the statement that decides the verdict, or None."""
    decisive = (Shows.STABILITY, Shows.INSTABILITY)
    return next((item for item in statements if item.shows in decisive), None)


def common_quadratic_of(
    system: SwitchedSystem, statements: Iterable[AbstractEvidence]
) -> CommonQuadraticStatus:
    """Return what checked statements say about a common quadratic function."""
    for item in statements:
        if item.is_common_quadratic:
            return CommonQuadraticStatus.EXISTS
        # Where no reset moves the state, such a function would prove stability.
        unstable = item.shows is Shows.INSTABILITY and not system.switching.resets
        if item.shows is Shows.NO_COMMON_QUADRATIC or unstable or item.names_unstable_mode:
            return CommonQuadraticStatus.IMPOSSIBLE
    return CommonQuadraticStatus.UNKNOWN


def to_document(certificate: Certificate) -> dict[str, Any]:
    """Return the JSON document of a certificate, without its id."""
    system = certificate.system
    document = {
        "schema": certificate.schema,
        "verdict": certificate.verdict,
        "spec": {"name": certificate.spec_name, "sha256": certificate.spec_sha256},
        "coordinates": certificate.coordinates,
        "gains": {name: dict(values) for name, values in certificate.gains.items()},
        **system_fields(system),
        "statements": [
            {"kind": item.kind, "claim": item.claim(system), **item.to_fields()}
            for item in certificate.statements
        ],
        "package": {"name": "nrs-design", "version": certificate.version},
    }
    if certificate.schema == FORMER:
        document["modes"] = [mode.name for mode in system.modes]
        del document["switching"]
    return document


def content_id(document: Mapping[str, Any]) -> str:
    """Return the SHA-256 over a document in canonical form, its ``id`` and origin left out."""
    content = {key: value for key, value in document.items() if key not in UNSIGNED}
    canonical = json.dumps(content, sort_keys=True, separators=(",", ":"), ensure_ascii=True)
    return hashlib.sha256(canonical.encode()).hexdigest()


def dump(certificate: Certificate, origin: str | None = None) -> str:
    """Return the text of the certificate file.

    Parameters
    ----------
    certificate : Certificate
        What is written.
    origin : str, optional
        Where its spec is, seen from the file; see `nrs_design.ownership`.
    """
    document = to_document(certificate)
    document["id"] = content_id(document)
    if origin is not None:
        document["origin"] = origin
    return json.dumps(document, indent=2, ensure_ascii=True) + "\n"
