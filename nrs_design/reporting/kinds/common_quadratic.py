"""A common quadratic function: its matrix, and how it decreases in every mode."""

from __future__ import annotations

import numpy as np

from nrs_design.proof.evidence import CommonQuadratic
from nrs_design.proof.mode import Time
from nrs_design.reporting.document import Illustration, Paragraph, Section
from nrs_design.reporting.figures.lyapunov import draw_quadratic
from nrs_design.reporting.formatting import number
from nrs_design.reporting.kinds.abstract import AbstractKindPage
from nrs_design.reporting.kinds.shared import words
from nrs_design.reporting.kinds.shared.matrix import SCALED, matrix_table
from nrs_design.reporting.kinds.shared.rates import rate_blocks
from nrs_design.reporting.kinds.shared.run import bounded_run, trials_per_step
from nrs_design.reporting.sections.modes import hardest_modes
from nrs_design.reporting.sections.titles import EVIDENCE
from nrs_design.simulation.norms import Array, quadratic_norm, scaled_matrices
from nrs_design.simulation.rates import mode_rates
from nrs_design.simulation.switched import worst_direction

_DECIDED = (
    "Q holds integers over a power of two, and integer arithmetic decides that Q is positive "
    "definite and decreases in every mode. The solver only proposed Q"
)
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


class CommonQuadraticPage(AbstractKindPage[CommonQuadratic]):
    """Q, and the rate of every mode in its norm."""

    @property
    def name(self) -> str:
        """Its kind."""
        return "common quadratic function"

    def meaning(self) -> tuple[str, ...]:
        """Say that it holds whatever switches happen."""
        return (
            words.free_bound(self.system),
            *words.unneeded_constant(self.system),
            *words.unneeded_rules(self.system),
            words.decision(_DECIDED),
        )

    def between_corners(self) -> tuple[str, ...]:
        """Say that they are covered."""
        return (words.all_corners(self.system, self.evidence),)

    def limits(self) -> tuple[str, ...]:
        """Say nothing: all signals and mixtures are covered."""
        return ()

    def sections(self, *, first: bool = True) -> tuple[Section, ...]:
        """Show the matrix of the certificate and how every mode decreases it."""
        (Q,) = scaled_matrices(self.evidence.Q)
        system, evidence = self.system, self.evidence
        text = (
            "The certificate holds the matrix Q of V(x) = x' Q x. "
            f"It is written with denominator 2^{evidence.denominator_log2}; here it is scaled. "
            + _cost_of_other_norm(Q)
        )
        illustration = Illustration(
            "quadratic",
            "Matrix of the common quadratic function",
            SCALED,
            draw_quadratic(Q, system.states),
        )
        rates, explained = mode_rates(system, Q), _RATES[system.time]
        blocks = (
            Paragraph(text),
            *matrix_table("Q divided by its largest entry", Q, system.states),
            illustration,
            *rate_blocks(system, rates, evidence.rate, "the norm of Q", explained),
        )
        return (Section(EVIDENCE, blocks),)

    def quadratic(self) -> tuple[Array, float]:
        """Return the matrix of the certificate, scaled, and its rate."""
        return scaled_matrices(self.evidence.Q)[0], float(self.evidence.rate)

    def run(self) -> Section:
        """Draw a run in the norm of Q, below its bound."""
        (Q,) = scaled_matrices(self.evidence.Q)
        hardest = hardest_modes(self.system, Q, trials_per_step(self.system))
        return bounded_run(
            self.system,
            hardest,
            quadratic_norm(Q),
            worst_direction(hardest, Q),
            float(self.evidence.rate),
            "in the norm of Q",
        )


def _cost_of_other_norm(Q: Array) -> str:
    spectrum = np.linalg.eigvalsh(Q)
    factor = float(np.sqrt(spectrum[-1] / spectrum[0])) if spectrum[0] > 0 else float("inf")
    return (
        "In the Euclidean norm of the states, in their units, the bound holds with the factor "
        f"{number(factor, 3)} in front (the root of Q's condition number)."
    )
