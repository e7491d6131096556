"""The evidence: for each statement of a certification, what it holds and a run that shows it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from nrs_design.proof.evidence import (
    AbstractEvidence,
    BlockTriangular,
    CommonPolynomial,
    CommonQuadratic,
    ModePolynomial,
    ModeQuadratic,
    NoCommonQuadratic,
    ParameterQuadratic,
    Shows,
)
from nrs_design.proof.system import SwitchedSystem
from nrs_design.reporting.document import Section
from nrs_design.reporting.sections.blocks import blocks_section
from nrs_design.reporting.sections.mode_polynomial import mode_polynomial_section
from nrs_design.reporting.sections.mode_quadratic import mode_quadratic_section
from nrs_design.reporting.sections.no_common_quadratic import no_common_quadratic_section
from nrs_design.reporting.sections.parameter_quadratic import parameter_quadratic_section
from nrs_design.reporting.sections.polynomial import polynomial_section
from nrs_design.reporting.sections.quadratic import quadratic_section
from nrs_design.reporting.sections.run import run_section
from nrs_design.reporting.sections.witness import witness_section

if TYPE_CHECKING:
    from nrs_design.search.certification import Certification


def evidence_sections(certification: Certification) -> Iterator[Section]:
    """Yield a section for every statement, and one with a run."""
    system, evidence = certification.system, certification.evidence
    drawn = False
    for statement in certification.statements:
        if isinstance(statement, BlockTriangular):
            yield blocks_section(system, statement, pattern=not drawn)
            drawn = True
        else:
            yield from _section(system, statement)
    if evidence is not None and evidence.shows is Shows.INSTABILITY:
        yield witness_section(system, evidence)
    else:
        yield run_section(system, evidence)


def _section(system: SwitchedSystem, statement: AbstractEvidence) -> Iterator[Section]:
    """Yield what a statement holds; a witness of instability is shown by its run alone."""
    if isinstance(statement, CommonQuadratic):
        yield quadratic_section(system, statement)
    elif isinstance(statement, CommonPolynomial):
        yield polynomial_section(system, statement)
    elif isinstance(statement, ModePolynomial):
        yield mode_polynomial_section(system, statement)
    elif isinstance(statement, ModeQuadratic):
        yield mode_quadratic_section(system, statement)
    elif isinstance(statement, ParameterQuadratic):
        yield parameter_quadratic_section(system, statement)
    elif isinstance(statement, NoCommonQuadratic):
        yield no_common_quadratic_section(system, statement)
