"""One quadratic function for contact and free motion: its matrix, and a run that bounces."""

from __future__ import annotations

import numpy as np

from nrs_design.proof.evidence import ConewiseQuadratic
from nrs_design.proof.system import Time
from nrs_design.reporting.document import Illustration, Paragraph, Section
from nrs_design.reporting.figures.contact import draw_deflection
from nrs_design.reporting.figures.lyapunov import draw_quadratic
from nrs_design.reporting.figures.run import draw_run
from nrs_design.reporting.kinds.abstract import AbstractKindPage
from nrs_design.reporting.kinds.shared import words
from nrs_design.reporting.kinds.shared.matrix import SCALED, matrix_table
from nrs_design.reporting.kinds.shared.rates import rate_blocks
from nrs_design.reporting.kinds.shared.run import (
    AGAINST,
    bound_line,
    freely,
    horizon,
    simulated,
    some_modes,
    trials_per_step,
    until_small,
)
from nrs_design.reporting.sections.modes import hardest_modes
from nrs_design.simulation.contact import contact_norm, with_free_modes, worst_contact
from nrs_design.simulation.norms import scaled_matrices
from nrs_design.simulation.rates import mode_rates
from nrs_design.simulation.switched import norms, worst_direction

_DECIDED = (
    "Q holds integers over a power of two, and integer arithmetic decides that Q is positive "
    "definite and decreases in every mode in contact, in every mode of free motion, and where "
    "contact is lost and made. The solver only proposed Q"
)
_RUN = (
    "Simulated run from the slowest direction in contact: at every step the adversary takes the "
    "possible mode after which the norm is largest. It is a bad run, not the worst one. The dashed "
    "line is the bound of the certificate, which holds for every switching signal and any loss of "
    "contact."
)
_RATES = (
    "How fast the norm of Q decays at least in each mode in contact. Free motion has conditions of "
    "its own, on the other states."
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
        return (
            "A force reference or a velocity command that pushes into the environment: they move "
            "the point of rest, and the bound is about the point of rest without them.",
        )

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
        system, rate = self.system, float(self.evidence.rate)
        hardest = hardest_modes(system, Q, trials_per_step(system))
        initial, norm = worst_direction(hardest, Q), contact_norm(Q)
        # It begins in contact.
        initial = initial if initial[-1] > 0 else -initial
        step, steps = horizon(with_free_modes(hardest), rate)
        response = worst_contact(hardest, norm, initial, step, steps)
        response = until_small(response, norms(response, norm))
        deflection = response.state[:, -1]
        unit = "steps" if system.time is Time.DISCRETE else "s"
        return simulated(
            Illustration(
                "run",
                AGAINST,
                f"{_RUN}{freely(system)}{some_modes(system, hardest)}",
                draw_run(
                    response,
                    norms(response, norm),
                    bound_line(response, rate, system.time, "proved bound, "),
                    with_free_modes(hardest),
                    "|w(t)| / |w(0)| in the norm of Q [1]",
                ),
            ),
            Illustration(
                "deflection",
                "Contact during this run",
                "Deflection of the same run; shaded where the environment is not touched.",
                draw_deflection(
                    response.time,
                    deflection / np.abs(deflection).max(),
                    system.states[-1],
                    unit,
                ),
            ),
        )
