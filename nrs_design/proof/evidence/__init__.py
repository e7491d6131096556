"""Kinds of evidence, one file each: what it claims, and the exact conditions to check.

Every class is imported from its module when it is first asked for: a proof loads the kinds that it
comes to use.
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from typing import TYPE_CHECKING, Any

from nrs_design.proof.evidence.abstract import AbstractEvidence as AbstractEvidence
from nrs_design.proof.evidence.abstract import Shows as Shows
from nrs_design.proof.system import SwitchedSystem

if TYPE_CHECKING:
    from nrs_design.proof.evidence.block_triangular import BlockTriangular as BlockTriangular
    from nrs_design.proof.evidence.constants_quadratic import (
        ConstantsQuadratic as ConstantsQuadratic,
    )
    from nrs_design.proof.evidence.graph import FormsOnGraph as FormsOnGraph
    from nrs_design.proof.evidence.growing_sequence import GrowingSequence as GrowingSequence
    from nrs_design.proof.evidence.invariant_ellipsoid import (
        InvariantEllipsoid as InvariantEllipsoid,
    )
    from nrs_design.proof.evidence.no_common_quadratic import NoCommonQuadratic as NoCommonQuadratic
    from nrs_design.proof.evidence.offset_ellipsoid import OffsetEllipsoid as OffsetEllipsoid
    from nrs_design.proof.evidence.saturated_ellipsoid import (
        SaturatedEllipsoid as SaturatedEllipsoid,
    )

# The name in a certificate file, and the class; its module has the same name as the kind.
KINDS: Mapping[str, str] = {
    "block-triangular": "BlockTriangular",
    "constants-quadratic": "ConstantsQuadratic",
    "graph": "FormsOnGraph",
    "growing-sequence": "GrowingSequence",
    "invariant-ellipsoid": "InvariantEllipsoid",
    "no-common-quadratic": "NoCommonQuadratic",
    "offset-ellipsoid": "OffsetEllipsoid",
    "saturated-ellipsoid": "SaturatedEllipsoid",
}

_HOMES = {name: kind.replace("-", "_") for kind, name in KINDS.items()}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)


def class_of(kind: str) -> type[AbstractEvidence]:
    """Return the class of a kind of evidence."""
    found: type[AbstractEvidence] = __getattr__(KINDS[kind])
    return found


def read_evidence(fields: Mapping[str, Any], system: SwitchedSystem) -> AbstractEvidence:
    """Read one statement of a certificate file.

    A KeyError, TypeError or ValueError if its kind is unknown, or a field is missing or malformed.
    """
    kind = fields["kind"]
    if kind not in KINDS:
        raise ValueError(f"unknown kind of evidence {kind!r}")
    return class_of(kind).from_fields(fields, system)
