"""Check a certificate by itself: that what it states holds for the modes that it holds.

No spec, no solver, no floating-point decision. Every sentence and every field that follows from
the modes and the evidence is regenerated and must agree to the letter.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from nrs_design.certificates.certificate import (
    SCHEMA,
    UNSIGNED,
    Certificate,
    content_id,
    to_document,
)
from nrs_design.errors import DISAGREE, InternalError, NrsDesignError
from nrs_design.proof.evidence import AbstractEvidence, Shows, read_evidence
from nrs_design.proof.evidence.fields import read_text
from nrs_design.proof.exact import IntegerMatrix
from nrs_design.proof.second_opinion import agrees
from nrs_design.proof.system import SwitchedSystem
from nrs_design.proof.system_fields import read_system
from nrs_design.proof.text import quoted

MAX_VERDICTS = 2
# What a hostile document can raise before the exact check: all of it means rejection.
_MALFORMED = (
    LookupError,
    TypeError,
    ValueError,
    ArithmeticError,
    AttributeError,
    RecursionError,
)


@dataclass(frozen=True, slots=True)
class Verification:
    """Outcome of a re-check: the certificate, and why it is rejected (None if it is valid).

    Beside it, for every statement, the forms that were decided, until flint has seen them.
    """

    certificate: Certificate | None
    fault: str | None
    forms: tuple[list[IntegerMatrix], ...] = field(default=(), repr=False, compare=False)

    def __bool__(self) -> bool:
        """Whether the certificate is valid and proves; one that refutes is valid, too."""
        certificate = self.certificate
        return self.fault is None and certificate is not None and certificate.verdict == "proved"


def prove(document: Mapping[str, Any]) -> Verification:
    """Check that a certificate holds for its own modes; whose they are is not asked.

    Parameters
    ----------
    document : mapping
        As `nrs_design.certificates.verify.read_document` gives it.
    """

    def check() -> Verification:
        altered = find_altered(document)
        return check_document(document, held_system(document)) if altered is None else altered

    return confirmed(check)


def find_altered(document: Mapping[str, Any]) -> Verification | None:
    """Reject a document that is not as it was written, or of another schema."""
    if document.get("id") != content_id(document):
        return Verification(None, "its content does not match its id: it was altered")
    if document.get("schema") != SCHEMA:
        other = f"its schema is not {SCHEMA}: another version of nrs-design made it"
        return Verification(None, f"{other}; make it again with certify-switching")
    return None


def held_system(document: Mapping[str, Any]) -> SwitchedSystem:
    """Return the system that a certificate holds.

    Raises
    ------
    KeyError, TypeError, ValueError
        If it holds none, or a malformed one.
    """
    return read_system(read_text(document["spec"]["name"]), document)


def check_document(document: Mapping[str, Any], system: SwitchedSystem) -> Verification:
    """Check every statement of a document for a system, and all that follows from it."""
    certificate = read_certificate(document, system)
    fault = _find_difference(document, certificate)
    forms = tuple(list[IntegerMatrix]() for _ in certificate.statements)
    for statement, made in zip(certificate.statements, forms, strict=True):
        fault = fault or statement.find_fault(system, made)
    return Verification(certificate, fault, forms)


def read_certificate(document: Mapping[str, Any], system: SwitchedSystem) -> Certificate:
    """Read what a document states of a system; whether it holds is not asked."""
    return Certificate(
        spec_name=read_text(document["spec"]["name"]),
        spec_sha256=read_text(document["spec"]["sha256"]),
        coordinates=_read_coordinates(document["coordinates"]),
        gains=read_gains(document),
        system=system,
        statements=_statements(document, system),
        version=read_text(document["package"]["version"]),
    )


def confirmed(judge: Callable[[], Verification]) -> Verification:
    """Return a judgement: a rejection where something is malformed, and not without flint.

    Raises
    ------
    InternalError
        If flint disagrees with what has been accepted.
    """
    verification = judged(judge)
    certificate = verification.certificate
    if certificate is None or verification.fault is not None:
        return verification
    system, statements = certificate.system, certificate.statements
    pairs = zip(statements, verification.forms, strict=True)
    if not all(agrees(system, item, forms) for item, forms in pairs):
        raise InternalError(DISAGREE)
    return Verification(certificate, None)


def judged(judge: Callable[[], Verification]) -> Verification:
    """Return a judgement, or a rejection where something is malformed."""
    try:
        return judge()
    except _MALFORMED as error:
        return Verification(None, f"a field is missing or malformed ({error})")
    except NrsDesignError as error:
        return Verification(None, error.message)


def read_gains(document: Mapping[str, Any]) -> dict[str, dict[str, str]]:
    """Read the gains of a certificate, by controller.

    Raises
    ------
    KeyError, TypeError
        If they are missing or malformed.
    """
    return {
        name: {gain: read_text(value) for gain, value in _mapping(values).items()}
        for name, values in _mapping(document["gains"]).items()
    }


def _read_coordinates(value: object) -> str | None:
    return None if value is None else read_text(value)


def _statements(
    document: Mapping[str, Any], system: SwitchedSystem
) -> tuple[AbstractEvidence, ...]:
    # Each may take seconds: a verdict and a remark on every block, said twice, are enough.
    bounds = (1 + len(system.channels)) * len(system.outputs)
    if len(document["statements"]) > 2 * (1 + system.order) + bounds:
        raise ValueError("it makes too many statements")
    statements = tuple(read_evidence(fields, system) for fields in document["statements"])
    decisive = (Shows.STABILITY, Shows.INSTABILITY)
    if sum(item.shows in decisive for item in statements) > MAX_VERDICTS:
        raise ValueError("it states its verdict too often")
    if not statements:
        raise ValueError("it states nothing")
    return statements


def _find_difference(document: Mapping[str, Any], certificate: Certificate) -> str | None:
    expected = to_document(certificate)
    for key in sorted(expected.keys() | (document.keys() - UNSIGNED)):
        # Membership too: a missing field is not the same as one that is null.
        if (key in document) != (key in expected) or _text_of(document, key) != _text_of(
            expected, key
        ):
            return f"its field {quoted(key)} does not follow from the modes and the evidence"
    return None


def _text_of(document: Mapping[str, Any], key: str) -> str:
    return json.dumps(document.get(key), sort_keys=True)


def _mapping(value: object) -> dict[str, Any]:
    if not isinstance(value, dict):
        raise TypeError(f"expected an object, not {quoted(str(value))}")
    return value
