"""The certificate: what is claimed, and the numbers that prove it."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from nrs_design.proof.assumption import Assumption
from nrs_design.proof.evidence import AbstractEvidence, Shows
from nrs_design.proof.evidence.abstract import AT_ANY_DEFLECTION, IN_KEPT_CONTACT
from nrs_design.proof.evidence.fields import system_fields
from nrs_design.proof.system import SwitchedSystem

SCHEMA = "nrs-design/certificate/9"
# Keys that do not change the claim, which the id does not cover.
UNSIGNED = frozenset({"id", "origin"})

# Conclusions that some motion grows.
GROWTH = frozenset({Shows.INSTABILITY, Shows.INSTABILITY_IN_CONTACT})

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


class AbstractChecked:
    """Checked statements about a system, with their conclusions."""

    __slots__ = ()
    system: SwitchedSystem
    statements: tuple[AbstractEvidence, ...]

    @property
    def evidence(self) -> AbstractEvidence | None:
        """The statement that decides the verdict, or None."""
        return deciding(self.system, self.statements)

    @property
    def refuted_in(self) -> str | None:
        """Scope of contact of a refutation that leaves the loss of contact undecided; or None."""
        return refuted_in(self.system, self.statements)

    @property
    def granted(self) -> tuple[Assumption, ...]:
        """Assumptions of the statements."""
        return granted(self.system, self.statements)


@dataclass(frozen=True, slots=True)
class Certificate(AbstractChecked):
    """A claim about one spec with the evidence for it."""

    # spec_name, spec_sha256: name of the spec, and hash of the content of its file.
    spec_name: str
    spec_sha256: str
    # ``deflection`` or ``force`` for an interaction design, None for given matrices.
    coordinates: str | None
    # Designed gains (float32, as exact decimals) by controller; empty for given matrices.
    gains: Gains
    system: SwitchedSystem  # Subject of the statements
    statements: tuple[AbstractEvidence, ...]  # At least one, each with its numbers
    version: str  # Version of this package
    # Points of the ranges that the system covers; empty for all points. Growth at a point refutes
    # the spec; other statements at points do not concern the spec.
    points: str = ""
    # Smallest and largest age of the force, in samples, if the goal `delay` requires a larger range
    # than the declared range. A proof for the larger range holds for the spec.
    ages: tuple[int, int] | None = None

    @property
    def verdict(self) -> str:
        """``proved``, ``refuted``, or ``inconclusive`` if it shows neither."""
        return str(verdict_of(self.system, self.statements))

    @property
    def common_quadratic(self) -> CommonQuadraticStatus:
        """What the statements say about a common quadratic function."""
        return common_quadratic_of(self.system, self.statements)

    @property
    def id(self) -> str:
        """SHA-256 over the canonical content."""
        return content_id(to_document(self))


def verdict_of(system: SwitchedSystem, statements: Iterable[AbstractEvidence]) -> Verdict:
    """Return the verdict that checked statements about a system carry."""
    conclusions = {statement.shown(system) for statement in statements}
    if Shows.STABILITY in conclusions:
        return Verdict.PROVED
    return Verdict.REFUTED if Shows.INSTABILITY in conclusions else Verdict.INCONCLUSIVE


def deciding(
    system: SwitchedSystem, statements: Iterable[AbstractEvidence]
) -> AbstractEvidence | None:
    """Return the statement that decides the verdict on a system, or None."""
    decisive = (Shows.STABILITY, Shows.INSTABILITY)
    return next((item for item in statements if item.shown(system) in decisive), None)


def refuted_in(system: SwitchedSystem, statements: Iterable[AbstractEvidence]) -> str | None:
    """Say of what checked statements refute stability, where that does not decide the verdict.

    That is kept contact, where its loss must be covered: the environment would have to pull.
    """
    if refutes_in_contact(system, statements) is None:
        return None
    return IN_KEPT_CONTACT if system.flights is None else AT_ANY_DEFLECTION


def refutes_in_contact(
    system: SwitchedSystem, statements: Iterable[AbstractEvidence]
) -> AbstractEvidence | None:
    """Return the statement that shows growth, where none decides and this one does not, or None."""
    statements = tuple(statements)
    if deciding(system, statements) is not None:
        return None
    growing = (s for s in statements if s.shown(system) is Shows.INSTABILITY_IN_CONTACT)
    return next(growing, None)


def granted(
    system: SwitchedSystem, statements: Iterable[AbstractEvidence]
) -> tuple[Assumption, ...]:
    """Return the assumptions; the model of contact loss is assumed by statements that cover it.

    Of a system about whose stability nothing is shown, all that was to be taken for granted.
    """
    contact = system.contact
    if contact is None or contact.loss is None:
        return system.assumptions
    decisive = [s for s in statements if s.shows in (Shows.STABILITY, Shows.INSTABILITY)]
    if decisive and not any(item.covers_loss(system) for item in decisive):
        return system.assumptions
    return (*system.assumptions, contact.loss)


def common_quadratic_of(
    system: SwitchedSystem, statements: Iterable[AbstractEvidence]
) -> CommonQuadraticStatus:
    """Return what checked statements say about a common quadratic function."""
    for item in statements:
        if item.is_common_quadratic:
            return CommonQuadraticStatus.EXISTS
        # Without resets, a common quadratic function would prove stability.
        unstable = item.shows is Shows.INSTABILITY and item.is_of_modes(system)
        unstable = unstable and (not system.switching.resets or item.names_unstable_mode)
        if item.shows is Shows.NO_COMMON_QUADRATIC or unstable:
            return CommonQuadraticStatus.IMPOSSIBLE
    return CommonQuadraticStatus.UNKNOWN


def to_document(certificate: Certificate) -> dict[str, Any]:
    """Return the JSON document of a certificate, without its id."""
    fields = system_fields(certificate.system)
    if not is_of_growth(certificate):
        # Which modes are attained matters only where something grows.
        fields.pop("enclosures", None)
    return {
        "schema": SCHEMA,
        "verdict": certificate.verdict,
        "spec": {"name": certificate.spec_name, "sha256": certificate.spec_sha256},
        "coordinates": certificate.coordinates,
        "gains": {name: dict(values) for name, values in certificate.gains.items()},
        **({} if not certificate.points else {"points": certificate.points}),
        **({} if certificate.ages is None else {"ages": [*certificate.ages]}),
        **fields,
        "statements": [{"kind": item.kind, **item.to_fields()} for item in certificate.statements],
        "package": {"name": "nrs-design", "version": certificate.version},
    }


def is_of_growth(certificate: Certificate) -> bool:
    """Tell whether a statement of a certificate is that some motion grows."""
    return any(item.shows in GROWTH for item in certificate.statements)


def canonical(document: Mapping[str, Any]) -> str:
    """Return a document in canonical form, its ``id`` and origin left out."""
    content = {key: value for key, value in document.items() if key not in UNSIGNED}
    return json.dumps(content, sort_keys=True, separators=(",", ":"), ensure_ascii=True)


def content_id(document: Mapping[str, Any]) -> str:
    """Return the SHA-256 over the canonical form of a document."""
    return hashlib.sha256(canonical(document).encode()).hexdigest()


def dump(certificate: Certificate, origin: str | None = None) -> str:
    """Return the text of the certificate file; `origin` is where its spec is, seen from there."""
    document = to_document(certificate)
    document["id"] = content_id(document)
    if origin is not None:
        document["origin"] = origin
    return json.dumps(document, indent=2, ensure_ascii=True) + "\n"
