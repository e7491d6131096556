"""All that a report says and draws of one kind of evidence: one file each, found by type."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from nrs_design.proof.evidence import (
    AbstractEvidence,
    BlockTriangular,
    CommonPolynomial,
    CommonQuadratic,
    ConewiseModeQuadratic,
    ConewisePolynomial,
    ConewiseQuadratic,
    ConstantForce,
    CoupledAxes,
    GrowingSequence,
    InvariantEllipsoid,
    ModePolynomial,
    ModeQuadratic,
    NoCommonQuadratic,
    ParameterQuadratic,
    PeriodicQuadratic,
    SaturatedEllipsoid,
)
from nrs_design.proof.system import SwitchedSystem
from nrs_design.reporting.kinds.abstract import AbstractKindPage
from nrs_design.reporting.kinds.block_triangular import BlockTriangularPage
from nrs_design.reporting.kinds.common_polynomial import CommonPolynomialPage
from nrs_design.reporting.kinds.common_quadratic import CommonQuadraticPage
from nrs_design.reporting.kinds.conewise_mode_quadratic import ConewiseModeQuadraticPage
from nrs_design.reporting.kinds.conewise_polynomial import ConewisePolynomialPage
from nrs_design.reporting.kinds.conewise_quadratic import ConewiseQuadraticPage
from nrs_design.reporting.kinds.constant_force import ConstantForcePage
from nrs_design.reporting.kinds.coupled_axes import CoupledAxesPage
from nrs_design.reporting.kinds.growing_sequence import GrowingSequencePage
from nrs_design.reporting.kinds.invariant_ellipsoid import InvariantEllipsoidPage
from nrs_design.reporting.kinds.mode_polynomial import ModePolynomialPage
from nrs_design.reporting.kinds.mode_quadratic import ModeQuadraticPage
from nrs_design.reporting.kinds.no_common_quadratic import NoCommonQuadraticPage
from nrs_design.reporting.kinds.parameter_quadratic import ParameterQuadraticPage
from nrs_design.reporting.kinds.periodic_quadratic import PeriodicQuadraticPage
from nrs_design.reporting.kinds.saturated_ellipsoid import SaturatedEllipsoidPage

KINDS: Mapping[type[AbstractEvidence], type[AbstractKindPage[Any]]] = {
    BlockTriangular: BlockTriangularPage,
    CommonPolynomial: CommonPolynomialPage,
    CommonQuadratic: CommonQuadraticPage,
    ConewiseModeQuadratic: ConewiseModeQuadraticPage,
    ConewisePolynomial: ConewisePolynomialPage,
    ConewiseQuadratic: ConewiseQuadraticPage,
    ConstantForce: ConstantForcePage,
    CoupledAxes: CoupledAxesPage,
    GrowingSequence: GrowingSequencePage,
    InvariantEllipsoid: InvariantEllipsoidPage,
    ModePolynomial: ModePolynomialPage,
    ModeQuadratic: ModeQuadraticPage,
    NoCommonQuadratic: NoCommonQuadraticPage,
    ParameterQuadratic: ParameterQuadraticPage,
    PeriodicQuadratic: PeriodicQuadraticPage,
    SaturatedEllipsoid: SaturatedEllipsoidPage,
}


def page_of(system: SwitchedSystem, evidence: AbstractEvidence) -> AbstractKindPage[Any]:
    """Return the page of a statement about a system."""
    return KINDS[type(evidence)](system, evidence)


__all__ = ["KINDS", "AbstractKindPage", "page_of"]
