"""Check a certificate by itself: its statements for its own modes.

No spec, no solver, no floating-point decision. Every sentence and every field that follows from
the modes and the evidence is regenerated and must agree to the letter.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NoReturn

from nrs_design.certificates.certificate import (
    GROWTH,
    SCHEMA,
    UNSIGNED,
    Certificate,
    content_id,
    to_document,
)
from nrs_design.certificates.second_opinion import agrees
from nrs_design.errors import DISAGREE, CertificateError, InternalError, NrsDesignError
from nrs_design.files import is_page, open_regular, read_json_text, unique_keys
from nrs_design.proof.evidence import AbstractEvidence, Shows, read_evidence
from nrs_design.proof.evidence.fields import read_system, read_text
from nrs_design.proof.exact import IntegerMatrix
from nrs_design.proof.system import SwitchedSystem
from nrs_design.proof.text import quoted

MAX_VERDICTS = 2
MAX_BYTES = 32 * 2**20
# Exceptions that a malformed document can raise before the exact check: each means rejection.
_MALFORMED = (LookupError, TypeError, ValueError, ArithmeticError, AttributeError, RecursionError)


@dataclass(frozen=True, slots=True)
class Verification:
    """Outcome of a re-check: the certificate, and why it is rejected (None if it is valid).

    Beside it, for every statement, the forms that were decided, until flint has seen them.
    """

    certificate: Certificate | None
    fault: str | None
    forms: tuple[list[IntegerMatrix], ...] = field(default=(), repr=False, compare=False)

    def __bool__(self) -> bool:
        """Whether the certificate is valid and proves stability."""
        certificate = self.certificate
        return self.fault is None and certificate is not None and certificate.verdict == "proved"


def read_document(path: Path) -> dict[str, Any]:
    """Read a certificate file as JSON without floats or duplicate keys.

    A `CertificateError` if it is missing, too large, or not such JSON.
    """
    content = b""
    try:
        content = _read_bytes(path)
        document = json.loads(
            read_json_text(content),
            parse_float=_no_float,
            parse_constant=_no_float,
            object_pairs_hook=unique_keys,
        )
    except OSError as error:
        raise CertificateError(f"cannot be read ({error.strerror})", path=path) from error
    except (ValueError, RecursionError) as error:
        if path.name.endswith((".yaml", ".yml")):
            raise CertificateError(
                "this is a spec, not a certificate",
                path=path,
                remedy="name the certificate first: nrs-design verify CERT SPEC",
            ) from error
        said = "this is a page" if is_page(content) else str(error)
        raise CertificateError(
            f"not a certificate: {said}", path=path, remedy="make it with certify-switching --out"
        ) from error
    if not isinstance(document, dict):
        raise CertificateError("not a certificate: expected a JSON object", path=path)
    return document


def _read_bytes(path: Path) -> bytes:
    """Read a file up to the largest size of a certificate."""
    if path.exists() and not (path.is_file() or path.is_dir()):
        raise CertificateError("is not a regular file", path=path)
    with open_regular(path) as file:
        content = file.read(MAX_BYTES + 1)
    if len(content) > MAX_BYTES:
        raise CertificateError("larger than any certificate", path=path)
    return content


def prove(document: Mapping[str, Any]) -> Verification:
    """Check that a certificate holds for its own modes; whose they are is not asked."""

    def check() -> Verification:
        altered = find_altered(document)
        return check_document(document, held_system(document)) if altered is None else altered

    return confirmed(check)


def find_altered(document: Mapping[str, Any]) -> Verification | None:
    """Reject a document that was altered, or has another schema."""
    if document.get("id") != content_id(document):
        return Verification(None, "its content does not match its id: it was altered")
    if document.get("schema") != SCHEMA:
        other = f"its schema is not {SCHEMA}: another version of nrs-design made it"
        return Verification(None, f"{other}; make it again with certify-switching")
    return None


def held_system(document: Mapping[str, Any]) -> SwitchedSystem:
    """Return the system that a certificate holds.

    A KeyError, TypeError or ValueError if it holds none, or a malformed one.
    """
    return read_system(read_text(document["spec"]["name"]), document)


def check_document(document: Mapping[str, Any], system: SwitchedSystem) -> Verification:
    """Check every statement of a document for a system, and all that follows from it."""
    certificate = read_certificate(document, system)
    fault = _find_difference(document, certificate)
    if certificate.points and not all(item.shows in GROWTH for item in certificate.statements):
        fault = fault or "it is about points of the ranges, where only growth says something"
    if certificate.ages and not all(item.shows.is_good for item in certificate.statements):
        fault = fault or "what grows with an older force than the spec declares says nothing of it"
    forms = tuple(list[IntegerMatrix]() for _ in certificate.statements)
    for statement, made in zip(certificate.statements, forms, strict=True):
        fault = fault or statement.find_fault(system, made)
    return Verification(certificate, fault, forms)


def read_certificate(document: Mapping[str, Any], system: SwitchedSystem) -> Certificate:
    """Read the certificate of a document, without a check."""
    coordinates = document["coordinates"]
    return Certificate(
        spec_name=read_text(document["spec"]["name"]),
        spec_sha256=read_text(document["spec"]["sha256"]),
        coordinates=None if coordinates is None else read_text(coordinates),
        gains=read_gains(document),
        system=system,
        statements=_statements(document, system),
        version=read_text(document["package"]["version"]),
        points=read_points(document),
        ages=read_ages(document),
    )


def read_points(document: Mapping[str, Any]) -> str:
    """Read at which points of the ranges a system stands; empty for all of them."""
    return read_text(document["points"]) if "points" in document else ""


def read_ages(document: Mapping[str, Any]) -> tuple[int, int] | None:
    """Read which ages of the force a system has beyond the declared ones; None for no others."""
    if "ages" not in document:
        return None
    low, high = document["ages"]
    if type(low) is not int or type(high) is not int:
        raise TypeError("ages are numbers of samples")
    return low, high


def confirmed(judge: Callable[[], Verification]) -> Verification:
    """Return a judgement as `judged` does, and not without flint.

    An `InternalError` if flint disagrees with what has been accepted.
    """
    verification = judged(judge)
    certificate = verification.certificate
    if certificate is None or verification.fault is not None:
        return verification
    pairs = zip(certificate.statements, verification.forms, strict=True)
    if not all(agrees(certificate.system, item, forms) for item, forms in pairs):
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
    """Read the gains of a certificate, by controller; a KeyError or TypeError if malformed."""
    return {
        name: {gain: read_text(value) for gain, value in _mapping(values).items()}
        for name, values in _mapping(document["gains"]).items()
    }


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
        if _text_of(document, key) != _text_of(expected, key):
            return f"its field {quoted(key)} does not follow from the modes and the evidence"
    return None


def _text_of(document: Mapping[str, Any], key: str) -> str:
    # A missing field and a null field differ.
    return json.dumps(document[key], sort_keys=True) if key in document else ""


def _mapping(value: object) -> dict[str, Any]:
    if not isinstance(value, dict):
        raise TypeError(f"expected an object, not {quoted(str(value))}")
    return value


def _no_float(text: str) -> NoReturn:
    raise ValueError(f"{quoted(text)} is a floating-point number; certificates hold integers only")
