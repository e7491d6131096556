"""The certificate: what is claimed, and the numbers that prove it."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from decimal import ROUND_DOWN, ROUND_UP, Context, Decimal
from enum import StrEnum
from fractions import Fraction
from typing import Any

from nrs_design.switched.system import SwitchedSystem, Time

SCHEMA = "nrs-design/certificate/1"

Gains = Mapping[str, Mapping[str, str]]


class Kind(StrEnum):
    """What a certificate shows, and by which argument."""

    COMMON_QUADRATIC = "common-quadratic"
    UNSTABLE_MODE = "unstable-mode"


@dataclass(frozen=True, slots=True)
class CommonQuadratic:
    """Evidence of stability: one quadratic Lyapunov function for all modes.

    Parameters
    ----------
    Q : tuple of tuple of int, shape (n, n)
        Numerators of the symmetric matrix of ``V(x) = x' Q x``.
    denominator_log2 : int
        Q is these numerators over two to this power.
    rate : Fraction
        Continuous time: the decay rate alpha in 1/s, with ``A'Q + QA + 2 alpha Q < 0``.
        Discrete time: the contraction rho per step, with ``A'QA < rho^2 Q``.
    """

    Q: tuple[tuple[int, ...], ...]
    denominator_log2: int
    rate: Fraction


@dataclass(frozen=True, slots=True)
class UnstableMode:
    """Evidence of instability: one mode that is not Hurwitz (not Schur, in discrete time).

    Parameters
    ----------
    mode : str
        Its name.
    eigenvalue : str
        An eigenvalue that is not in the stable region, to six digits, for the reader.
    """

    mode: str
    eigenvalue: str


Evidence = CommonQuadratic | UnstableMode


@dataclass(frozen=True, slots=True)
class Certificate:
    """A claim about one spec with the evidence for it.

    Parameters
    ----------
    spec_name, spec_sha256 : str
        The spec that it belongs to, and the hash of that file's bytes.
    coordinates : str or None
        ``deflection`` or ``force`` for an interaction design, None for given matrices.
    gains : mapping
        Designed gains (float32, as exact decimals) by controller; empty for given matrices.
    system : SwitchedSystem
        Its time axis, names and assumptions are quoted; its matrices are never stored.
    evidence : CommonQuadratic or UnstableMode
        The numbers to check.
    version : str
        Version of this package.
    """

    spec_name: str
    spec_sha256: str
    coordinates: str | None
    gains: Gains
    system: SwitchedSystem
    evidence: Evidence
    version: str

    @property
    def verdict(self) -> str:
        """``proved`` or ``refuted``."""
        return "proved" if isinstance(self.evidence, CommonQuadratic) else "refuted"

    @property
    def id(self) -> str:
        """SHA-256 over the canonical content."""
        return content_id(to_document(self))


def claim(system: SwitchedSystem, evidence: Evidence) -> str:
    """Say in words what the evidence shows about the system."""
    continuous = system.time is Time.CONTINUOUS
    law = "x' = A x" if continuous else "x+ = A x"
    if isinstance(evidence, UnstableMode):
        region = "Hurwitz" if continuous else "Schur"
        return (
            f"Mode {evidence.mode} is not {region} (eigenvalue {evidence.eigenvalue}): staying in "
            f"it is an admissible switching signal, so {law} is not uniformly exponentially stable."
        )
    bound = "exp(-alpha t) |x(0)|" if continuous else "rho^t |x(0)|"
    value = rate_text(evidence.rate, system.time)
    rate = f"alpha = {value} 1/s" if continuous else f"rho = {value}"
    count = len(system.modes)
    among = "its one mode" if count == 1 else f"the {count} modes"
    return (
        f"Every solution of {law}, switching arbitrarily among {among}, satisfies "
        f"|x(t)| <= {bound} with {rate}, in the norm |x| = sqrt(x' Q x)."
    )


def rate_text(rate: Fraction, time: Time) -> str:
    """Write a rate with six digits, rounded to its safe side (slower decay)."""
    rounding = ROUND_DOWN if time is Time.CONTINUOUS else ROUND_UP
    context = Context(prec=6, rounding=rounding)
    return str(context.divide(Decimal(rate.numerator), Decimal(rate.denominator)))


def to_document(certificate: Certificate) -> dict[str, Any]:
    """Return the JSON document of a certificate, without its id."""
    evidence = certificate.evidence
    system = certificate.system
    document: dict[str, Any] = {
        "schema": SCHEMA,
        "kind": str(_kind(evidence)),
        "verdict": certificate.verdict,
        "claim": claim(system, evidence),
        "spec": {"name": certificate.spec_name, "sha256": certificate.spec_sha256},
        "time": str(system.time),
        "coordinates": certificate.coordinates,
        "states": list(system.states),
        "modes": [mode.name for mode in system.modes],
        "gains": {name: dict(values) for name, values in certificate.gains.items()},
        "assumptions": list(system.assumptions),
        "package": {"name": "nrs-design", "version": certificate.version},
    }
    if isinstance(evidence, CommonQuadratic):
        document["Q"] = {
            "numerators": [list(row) for row in evidence.Q],
            "denominator_log2": evidence.denominator_log2,
        }
        document["rate"] = str(evidence.rate)
    else:
        document["unstable_mode"] = {"name": evidence.mode, "eigenvalue": evidence.eigenvalue}
    return document


def content_id(document: Mapping[str, Any]) -> str:
    """Return the SHA-256 over a document in canonical form, its ``id`` left out."""
    content = {key: value for key, value in document.items() if key != "id"}
    canonical = json.dumps(content, sort_keys=True, separators=(",", ":"), ensure_ascii=True)
    return hashlib.sha256(canonical.encode()).hexdigest()


def dump(certificate: Certificate) -> str:
    """Return the text of the certificate file."""
    document = to_document(certificate)
    return json.dumps({**document, "id": content_id(document)}, indent=2, ensure_ascii=True) + "\n"


def _kind(evidence: Evidence) -> Kind:
    return Kind.COMMON_QUADRATIC if isinstance(evidence, CommonQuadratic) else Kind.UNSTABLE_MODE
