"""Re-check a certificate file against its spec: no solver, no floating-point decision.

The matrices are assembled from the spec; the certificate contributes the designed gains, the
evidence and the rate. Every other field is regenerated and must agree to the letter.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

from nrs_design.certificates.certificate import (
    SCHEMA,
    UNSIGNED,
    Certificate,
    content_id,
    to_document,
)
from nrs_design.errors import DISAGREE, CertificateError, InternalError, NrsDesignError
from nrs_design.files import open_regular, read_json_text
from nrs_design.models.plant import Plant
from nrs_design.proof.evidence import AbstractEvidence, Shows, read_evidence
from nrs_design.proof.evidence.fields import read_text
from nrs_design.proof.second_opinion import agrees
from nrs_design.proof.system import SwitchedSystem
from nrs_design.proof.text import quoted
from nrs_design.spec import LoadedSpec
from nrs_design.switched.assemble import assemble_from_text

MAX_BYTES = 32 * 2**20
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
    """Outcome of a re-check: the certificate, and why it is rejected (None if it is valid)."""

    certificate: Certificate | None
    fault: str | None


def verify(
    path: Path, spec: LoadedSpec, coordinates: str | None = None, plant: Plant | None = None
) -> Verification:
    """Re-check a certificate file against the spec that it is said to belong to.

    Parameters
    ----------
    path : Path
        Certificate file.
    spec : LoadedSpec
        The spec, as read from its own file.
    coordinates : {"deflection", "force"}, optional
        That the certificate must be about; those of the spec by default.
    plant : Plant, optional
        Built from this very spec, where it is in hand; by default it is built here.

    Raises
    ------
    CertificateError
        If the file cannot be read as a certificate of this format at all.
    """
    return verify_document(read_document(path), spec, coordinates, plant)


def verify_document(
    document: Mapping[str, Any],
    spec: LoadedSpec,
    coordinates: str | None = None,
    plant: Plant | None = None,
) -> Verification:
    """Re-check a parsed certificate.

    Parameters
    ----------
    document : mapping
        As `read_document` gives it.
    spec, coordinates, plant
        As for `verify`.
    """
    try:
        foreign = _find_foreign(document, spec, coordinates)
        if foreign is not None:
            return Verification(None, foreign)
        certificate = _rebuild(document, spec, plant)
        fault = _find_difference(document, certificate)
        for statement in certificate.statements:
            fault = fault or statement.find_fault(certificate.system)
    except _MALFORMED as error:
        return Verification(None, f"a field is missing or malformed ({error})")
    except NrsDesignError as error:
        return Verification(None, error.message)
    if fault is None:
        for statement in certificate.statements:
            if not agrees(certificate.system, statement):
                raise InternalError(DISAGREE)
    return Verification(certificate, fault)


def read_document(path: Path) -> dict[str, Any]:
    """Read a certificate file as JSON without floats or duplicate keys.

    Raises
    ------
    CertificateError
        If the file is missing, too large, or not such JSON.
    """
    try:
        document = json.loads(
            read_json_text(_read_bytes(path)),
            parse_float=_no_float,
            parse_constant=_no_float,
            object_pairs_hook=_unique,
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
        raise CertificateError(
            f"not a certificate: {error}", path=path, remedy="make it with certify-switching --out"
        ) from error
    if not isinstance(document, dict):
        raise CertificateError("not a certificate: expected a JSON object", path=path)
    return document


def _read_bytes(path: Path) -> bytes:
    """Read a whole file, but never an endless one."""
    if path.exists() and not (path.is_file() or path.is_dir()):
        raise CertificateError("is not a regular file", path=path)
    with open_regular(path) as file:
        content = file.read(MAX_BYTES + 1)
    if len(content) > MAX_BYTES:
        raise CertificateError("larger than any certificate", path=path)
    return content


def _find_foreign(
    document: Mapping[str, Any], spec: LoadedSpec, coordinates: str | None
) -> str | None:
    """Say why a document is not an unaltered certificate for this spec."""
    if document.get("id") != content_id(document):
        return "its content does not match its id: it was altered"
    if document.get("schema") != SCHEMA:
        return f"its schema is not {SCHEMA}: another version of nrs-design made it, make it anew"
    if document.get("spec") != {"name": spec.spec.name, "sha256": spec.sha256}:
        return "it belongs to another spec, or the spec has changed since"
    wanted = coordinates or getattr(spec.spec, "coordinates", None)
    if document.get("coordinates") != wanted:
        return f"it is about other coordinates than {wanted}"
    return None


def _rebuild(document: Mapping[str, Any], spec: LoadedSpec, plant: Plant | None) -> Certificate:
    coordinates = document["coordinates"]
    gains = _mapping(document["gains"])
    system = assemble_from_text(spec.spec, gains, coordinates, plant=plant)
    return Certificate(
        spec_name=spec.spec.name,
        spec_sha256=spec.sha256,
        coordinates=coordinates,
        gains=gains,
        system=system,
        statements=_statements(document, system),
        version=read_text(document["package"]["version"]),
    )


def _statements(
    document: Mapping[str, Any], system: SwitchedSystem
) -> tuple[AbstractEvidence, ...]:
    # Each may take seconds: a verdict and a remark on every block, said twice, are enough.
    if len(document["statements"]) > 2 * (1 + system.order):
        raise ValueError("it makes too many statements")
    statements = tuple(read_evidence(fields, system) for fields in document["statements"])
    if sum(item.shows is not Shows.NO_COMMON_QUADRATIC for item in statements) > MAX_VERDICTS:
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
            return f"its field {quoted(key)} does not follow from the spec and the evidence"
    return None


def _text_of(document: Mapping[str, Any], key: str) -> str:
    return json.dumps(document.get(key), sort_keys=True)


def _mapping(value: object) -> dict[str, Any]:
    if not isinstance(value, dict):
        raise TypeError(f"expected an object, not {quoted(str(value))}")
    return value


def _no_float(text: str) -> NoReturn:
    raise ValueError(f"{quoted(text)} is a floating-point number; certificates hold integers only")


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    keys = [key for key, _ in pairs]
    if len(set(keys)) != len(keys):
        raise ValueError("a key occurs twice")
    return dict(pairs)
