"""A quadratic function that depends on a constant parameter: its margin over the parameter."""

from __future__ import annotations

import numpy as np

from nrs_design.certificates.evidence import ParameterQuadratic
from nrs_design.certificates.evidence.fields import rate_words
from nrs_design.reporting.document import Illustration, Paragraph, Section, Table
from nrs_design.reporting.figures.lyapunov import draw_parameter_rates, draw_quadratics
from nrs_design.reporting.formatting import number
from nrs_design.reporting.sections.quadratic import SCALED, matrix_table
from nrs_design.simulation.margins import parameter_rates
from nrs_design.simulation.norms import Array, function_at
from nrs_design.switched.system import SwitchedSystem

_POINTS = 61
_LISTED = 24
_DRAWN = 8


def parameter_quadratic_section(system: SwitchedSystem, evidence: ParameterQuadratic) -> Section:
    """Show Q at both ends, and the decay rate of every mode over the parameter."""
    ends = {"low end": function_at(evidence, 0.0), "high end": function_at(evidence, 1.0)}
    values = np.linspace(0.0, 1.0, _POINTS)
    names, rates = parameter_rates(system, evidence, values)
    hardest = np.sort(np.argsort(rates.min(axis=0), kind="stable")[:_DRAWN])
    some = f" The {_DRAWN} slowest of {len(names)} modes." if len(names) > _DRAWN else ""
    text = (
        "The certificate holds Q at both ends of the parameter's range; between them Q is affine. "
        f"It is written with denominator 2^{evidence.denominator_log2}; here both ends are divided "
        "by the largest entry."
    )
    return Section(
        "Lyapunov evidence",
        (
            Paragraph(text),
            *matrix_table("Q at the low end", ends["low end"], system.states),
            *matrix_table("Q at the high end", ends["high end"], system.states),
            Illustration(
                "quadratics", "Matrices at both ends", SCALED, draw_quadratics(ends, system.states)
            ),
            _table(names, values, rates, rate_words(evidence.rate, system.time)),
            Illustration(
                "parameter-rates",
                "Decrease over the parameter",
                "Half the smallest eigenvalue of the decrease relative to Q, both at the same "
                "value of the parameter: the rate at which the norm of Q decays at least. All "
                f"curves lie above the claimed rate, over the whole range.{some}",
                draw_parameter_rates(
                    [names[i] for i in hardest], values, rates[:, hardest], evidence.rate
                ),
            ),
        ),
    )


def _table(names: list[str], values: Array, rates: Array, claimed: str) -> Table:
    order = np.argsort(rates.min(axis=0), kind="stable")[:_LISTED]
    rows = tuple(
        (
            names[i],
            number(float(rates[:, i].min()), 6),
            number(float(values[rates[:, i].argmin()]), 3),
        )
        for i in order
    )
    columns = ("Mode", "Smallest decay rate [1/s]", "At the parameter [0 low, 1 high]")
    return Table(f"Slowest decay over the parameter; claimed: {claimed}", columns, rows)
