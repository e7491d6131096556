"""A common quadratic function: its matrix, and how it decreases in every mode."""

from __future__ import annotations

import numpy as np

from nrs_design.proof.evidence import CommonQuadratic
from nrs_design.proof.system import SwitchedSystem, Time
from nrs_design.reporting.document import Block, Illustration, Paragraph, Section, Table
from nrs_design.reporting.figures.lyapunov import draw_quadratic
from nrs_design.reporting.formatting import number
from nrs_design.reporting.sections.rates import rate_blocks
from nrs_design.simulation.norms import Array, scaled_matrices
from nrs_design.simulation.rates import mode_rates

WRITTEN = 8
_RATES = {
    Time.CONTINUOUS: (
        "Half the smallest eigenvalue of -(A'Q + QA) relative to Q: the rate at which the norm of "
        "Q decays at least in this mode."
    ),
    Time.DISCRETE: (
        "Root of the largest eigenvalue of A'QA relative to Q: the factor by which the norm of Q "
        "shrinks at least in a step of this mode."
    ),
}
SCALED = (
    "Q(i,j) / sqrt(Q(i,i) Q(j,j)): the diagonal becomes one and the states lose their units. An "
    "entry near 1 or -1 says that two states act together in V."
)


def quadratic_section(system: SwitchedSystem, evidence: CommonQuadratic) -> Section:
    """Show the matrix of the certificate and how every mode decreases it."""
    (Q,) = scaled_matrices(evidence.Q)
    text = (
        "The certificate holds the matrix Q of V(x) = x' Q x. "
        f"It is written with denominator 2^{evidence.denominator_log2}; here it is scaled. "
        + _cost_of_other_norm(Q)
    )
    return Section(
        "Lyapunov evidence",
        (
            Paragraph(text),
            *matrix_table("Q divided by its largest entry", Q, system.states),
            Illustration(
                "quadratic",
                "Matrix of the common quadratic function",
                SCALED,
                draw_quadratic(Q, system.states),
            ),
            *rate_blocks(
                system,
                mode_rates(system, Q),
                evidence.rate,
                "the norm of Q",
                _RATES[system.time],
            ),
        ),
    )


def matrix_table(title: str, Q: Array, states: tuple[str, ...]) -> list[Block]:
    """Return a matrix as a table, or nothing if it is too large for a page.

    Parameters
    ----------
    title : str
        Caption.
    Q : ndarray, shape (n, n)
        The matrix.
    states : tuple of str
        Names of rows and columns.
    """
    if len(Q) > WRITTEN:
        return []
    names = states[: len(Q)]
    rows = tuple((name, *(number(v, 5) for v in row)) for name, row in zip(names, Q, strict=True))
    return [Table(title, ("", *names), rows)]


def _cost_of_other_norm(Q: Array) -> str:
    spectrum = np.linalg.eigvalsh(Q)
    factor = float(np.sqrt(spectrum[-1] / spectrum[0])) if spectrum[0] > 0 else float("inf")
    return (
        "In the Euclidean norm of the states, in their units, the bound holds with the factor "
        f"{number(factor, 3)} in front (the root of Q's condition number)."
    )
