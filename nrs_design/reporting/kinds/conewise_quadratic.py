"""One quadratic function for contact and free motion: its matrix, and a run that bounces."""

from __future__ import annotations

from nrs_design.proof.evidence import ConewiseQuadratic
from nrs_design.reporting.document import Illustration, Paragraph, Section
from nrs_design.reporting.figures.lyapunov import draw_quadratic
from nrs_design.reporting.kinds.shared.bouncing import bouncing_run
from nrs_design.reporting.kinds.shared.conewise import AbstractConewisePage
from nrs_design.reporting.kinds.shared.matrix import SCALED, matrix_table
from nrs_design.reporting.kinds.shared.rates import rate_blocks
from nrs_design.reporting.kinds.shared.run import trials_per_step
from nrs_design.reporting.sections.modes import hardest_modes
from nrs_design.reporting.sections.titles import EVIDENCE
from nrs_design.simulation.contact import clipped
from nrs_design.simulation.norms import Array, quadratic_norm, scaled_matrices
from nrs_design.simulation.rates import mode_rates
from nrs_design.simulation.switched import worst_direction

_RATES = (
    "How fast the norm of Q decays at least in each mode in contact. Free motion has conditions of "
    "its own, on the other states."
)


class ConewiseQuadraticPage(AbstractConewisePage[ConewiseQuadratic]):
    """Q, the rate of every mode in its norm, and a run through contact and free motion."""

    function = "The function is x' Q x in contact; in free motion the deflection is left out of it."
    decided = (
        "Q holds integers over a power of two, and integer arithmetic decides that Q is positive "
        "definite and decreases in every mode in contact, in every mode of free motion, and where "
        "contact is lost and made. The solver only proposed Q"
    )

    @property
    def name(self) -> str:
        """Its kind."""
        return "quadratic function for contact and free motion"

    def sections(self, *, first: bool = True) -> tuple[Section, ...]:
        """Show the matrix of the certificate and how every mode in contact decreases it."""
        (Q,) = scaled_matrices(self.evidence.Q)
        system, evidence = self.system, self.evidence
        text = (
            "The certificate holds the matrix Q of V(w) = w' Q w, with the deflection as its last "
            f"state. It is written with denominator 2^{evidence.denominator_log2}; here it is "
            "scaled."
        )
        blocks = (
            Paragraph(text),
            *matrix_table("Q divided by its largest entry", Q, system.states),
            Illustration(
                "quadratic",
                "Matrix of the function for contact and free motion",
                SCALED,
                draw_quadratic(Q, system.states),
            ),
            *rate_blocks(system, mode_rates(system, Q), evidence.rate, "the norm of Q", _RATES),
        )
        return (Section(EVIDENCE, blocks),)

    def quadratic(self) -> tuple[Array, float]:
        """Return the matrix of the certificate, scaled, and its rate."""
        return scaled_matrices(self.evidence.Q)[0], float(self.evidence.rate)

    def run(self) -> Section:
        """Draw a run in the norm of Q, below its bound, and when contact is lost."""
        (Q,) = scaled_matrices(self.evidence.Q)
        hardest = hardest_modes(self.system, Q, trials_per_step(self.system))
        return bouncing_run(
            self.system,
            hardest,
            clipped(quadratic_norm(Q)),
            worst_direction(hardest, Q),
            float(self.evidence.rate),
            "in the norm of Q",
        )
