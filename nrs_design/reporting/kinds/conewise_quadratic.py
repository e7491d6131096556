"""One quadratic function for contact and free motion: its matrix, and a run that bounces."""

from __future__ import annotations

from nrs_design.proof.evidence import ConewiseQuadratic
from nrs_design.reporting.document import Illustration, Paragraph, Section
from nrs_design.reporting.figures.lyapunov import draw_quadratic
from nrs_design.reporting.kinds.abstract import AbstractKindPage
from nrs_design.reporting.kinds.shared import words
from nrs_design.reporting.kinds.shared.bouncing import bouncing_run
from nrs_design.reporting.kinds.shared.matrix import SCALED, matrix_table
from nrs_design.reporting.kinds.shared.rates import rate_blocks
from nrs_design.reporting.kinds.shared.run import trials_per_step
from nrs_design.reporting.sections.modes import hardest_modes
from nrs_design.simulation.contact import clipped
from nrs_design.simulation.norms import quadratic_norm, scaled_matrices
from nrs_design.simulation.rates import mode_rates
from nrs_design.simulation.switched import worst_direction

_DECIDED = (
    "Q holds integers over a power of two, and integer arithmetic decides that Q is positive "
    "definite and decreases in every mode in contact, in every mode of free motion, and where "
    "contact is lost and made. The solver only proposed Q"
)
_RATES = (
    "How fast the norm of Q decays at least in each mode in contact. Free motion has conditions of "
    "its own, on the other states."
)
MOVED_REST = (
    "A force reference or a velocity command that pushes into the environment: they move the point "
    "of rest, and the bound is about the point of rest without them."
)


class ConewiseQuadraticPage(AbstractKindPage[ConewiseQuadratic]):
    """Q, the rate of every mode in its norm, and a run through contact and free motion."""

    @property
    def name(self) -> str:
        """Its kind."""
        return "quadratic function for contact and free motion"

    def meaning(self) -> tuple[str, ...]:
        """Say what is measured, and that no rule of switching is needed."""
        return (
            "The function is x' Q x in contact; in free motion the deflection is left out of it. "
            "So it measures motion, force and penetration, and not how far the axis has moved "
            "away from the surface: once it has come to rest in the air, it stays there.",
            words.free_bound(self.system),
            *words.unneeded_rules(self.system),
            words.decision(_DECIDED),
        )

    def between_corners(self) -> tuple[str, ...]:
        """Say that they are covered."""
        return (words.all_corners(self.system, self.evidence),)

    def limits(self) -> tuple[str, ...]:
        """Say what a constant force or command would change."""
        return (MOVED_REST,)

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
        return (Section("Lyapunov evidence", blocks),)

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
