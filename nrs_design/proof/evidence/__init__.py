"""Kinds of evidence, one file each: what it claims, and the exact conditions to check."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from nrs_design.proof.evidence.abstract import AbstractEvidence, Shows
from nrs_design.proof.evidence.block_triangular import BlockTriangular
from nrs_design.proof.evidence.common_polynomial import CommonPolynomial
from nrs_design.proof.evidence.common_quadratic import CommonQuadratic
from nrs_design.proof.evidence.conewise_polynomial import ConewisePolynomial
from nrs_design.proof.evidence.conewise_quadratic import ConewiseQuadratic
from nrs_design.proof.evidence.invariant_ellipsoid import InvariantEllipsoid
from nrs_design.proof.evidence.mode_polynomial import ModePolynomial
from nrs_design.proof.evidence.mode_quadratic import ModeQuadratic
from nrs_design.proof.evidence.no_common_quadratic import NoCommonQuadratic
from nrs_design.proof.evidence.parameter_quadratic import ParameterQuadratic
from nrs_design.proof.evidence.unstable_mixture import UnstableMixture
from nrs_design.proof.evidence.unstable_mode import UnstableMode
from nrs_design.proof.evidence.unstable_period import UnstablePeriod
from nrs_design.proof.evidence.unstable_value import UnstableValue
from nrs_design.proof.system import SwitchedSystem

KINDS: tuple[type[AbstractEvidence], ...] = (
    CommonQuadratic,
    CommonPolynomial,
    ConewiseQuadratic,
    ConewisePolynomial,
    InvariantEllipsoid,
    ModeQuadratic,
    ModePolynomial,
    NoCommonQuadratic,
    ParameterQuadratic,
    UnstableMode,
    UnstableMixture,
    UnstablePeriod,
    UnstableValue,
    BlockTriangular,
)


def read_evidence(fields: Mapping[str, Any], system: SwitchedSystem) -> AbstractEvidence:
    """Read one statement of a certificate file.

    Raises
    ------
    KeyError, TypeError, ValueError
        If its kind is unknown, or a field is missing or malformed.
    """
    for kind in KINDS:
        if kind.kind == fields["kind"]:
            return kind.from_fields(fields, system)
    raise ValueError(f"unknown kind of evidence {fields['kind']!r}")


__all__ = [
    "KINDS",
    "AbstractEvidence",
    "BlockTriangular",
    "CommonPolynomial",
    "CommonQuadratic",
    "ConewisePolynomial",
    "ConewiseQuadratic",
    "InvariantEllipsoid",
    "ModePolynomial",
    "ModeQuadratic",
    "NoCommonQuadratic",
    "ParameterQuadratic",
    "Shows",
    "UnstableMixture",
    "UnstableMode",
    "UnstablePeriod",
    "UnstableValue",
    "read_evidence",
]
