"""One quadratic function for each step of a round: matrices, and a run of rounds."""

from __future__ import annotations

import numpy as np

from nrs_design.proof.evidence import PeriodicQuadratic
from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.reporting.document import Illustration, Paragraph, Section
from nrs_design.reporting.figures.contact import draw_deflection
from nrs_design.reporting.figures.lyapunov import draw_quadratics
from nrs_design.reporting.figures.run import draw_run
from nrs_design.reporting.kinds.abstract import AbstractKindPage
from nrs_design.reporting.kinds.shared import words
from nrs_design.reporting.kinds.shared.conewise import MOVED_REST
from nrs_design.reporting.kinds.shared.matrix import SCALED, matrix_table
from nrs_design.reporting.kinds.shared.run import (
    AGAINST,
    bound_line,
    horizon,
    simulated,
    until_small,
)
from nrs_design.reporting.sections.titles import EVIDENCE
from nrs_design.simulation.contact import clipped
from nrs_design.simulation.norms import Array, Norm, quadratic_norm, scaled_matrices
from nrs_design.simulation.rounds import all_modes, norms_in_rounds, worst_rounds

_DRAWN = 6
_DIRECTIONS = 200
_TURNS = (
    "A round is what both loops take to meet again. The claim is about every sample of the faster "
    "loop, with the function of its place in the round; in another norm the same rate holds with a "
    "constant factor in front."
)
_RUN = (
    "Simulated run: at every step the adversary takes the mode, of those whose turn it is and that "
    "contact allows, after which the norm of that step is largest. It is a bad run, not the worst "
    "one. The dashed line is the bound of the certificate, which holds for every choice."
)


class PeriodicQuadraticPage(AbstractKindPage[PeriodicQuadratic]):
    """The matrices of some steps of a round, and a run."""

    @property
    def name(self) -> str:
        """Its kind."""
        return "quadratic function for each step of a round"

    def meaning(self) -> tuple[str, ...]:
        """Say what a round is, what is measured, and how it was decided."""
        free = ""
        if self.system.contact is not None:
            free = ", in free motion on the other states, and where contact is lost and made"
        return (
            "Each step of a round has a function x' Q x, which decreases to that of the next step; "
            "where contact is lost, the deflection is left out of it.",
            _TURNS,
            words.decision(
                "every Q holds integers over a power of two, and integer arithmetic decides that "
                "it is positive definite and decreases to the next one in every mode whose turn it "
                f"is{free}. The solver only proposed them"
            ),
        )

    def between_corners(self) -> tuple[str, ...]:
        """Say that they are covered."""
        return (words.all_corners(self.system, self.evidence),)

    def limits(self) -> tuple[str, ...]:
        """Say what a constant force or command would change, and what else is left out."""
        drift = "Two loops whose periods drift against each other: they meet at every round."
        return (MOVED_REST, drift)

    def sections(self, *, first: bool = True) -> tuple[Section, ...]:
        """Show the matrices of some steps of the round."""
        evidence, states = self.evidence, self.system.states
        matrices = scaled_matrices(*evidence.functions)
        count = len(matrices)
        shown = sorted({round(k * (count - 1) / (_DRAWN - 1)) for k in range(_DRAWN)})
        text = (
            f"The certificate holds one matrix Q for each of the {count} steps of a round, written "
            f"with denominator 2^{evidence.denominator_log2}; here all are divided by the largest "
            "entry of any."
        )
        some = "" if len(shown) == count else f" {len(shown)} of {count} steps."
        return (
            Section(
                EVIDENCE,
                (
                    Paragraph(text),
                    *matrix_table("Q of the first step of a round", matrices[0], states),
                    Illustration(
                        "quadratics",
                        "Matrices of the functions",
                        f"{SCALED}{some}",
                        draw_quadratics({f"step {k + 1}": matrices[k] for k in shown}, states),
                    ),
                ),
            ),
        )

    def run(self) -> Section:
        """Draw a run in the norms of the steps, below its bound, and when contact is lost."""
        system, rate = self.system, float(self.evidence.rate)
        norms = step_norms(self.evidence, system)
        _, steps = horizon(system, rate)
        response = worst_rounds(system, norms, _slowest(system, norms), steps)
        response = until_small(response, norms_in_rounds(response, norms))
        run = Illustration(
            "run",
            AGAINST,
            _RUN,
            draw_run(
                response,
                norms_in_rounds(response, norms),
                bound_line(response, rate, Time.DISCRETE, "proved bound, "),
                all_modes(system),
                "|w(t)| / |w(0)| in the norm of its step [1]",
            ),
        )
        if system.contact is None:
            return simulated(run)
        deflection = response.state[:, -1]
        contact = Illustration(
            "deflection",
            "Contact during this run",
            "Deflection of the same run; shaded where the environment is not touched.",
            draw_deflection(
                response.time, deflection / np.abs(deflection).max(), system.states[-1], "steps"
            ),
        )
        return simulated(run, contact)


def step_norms(evidence: PeriodicQuadratic, system: SwitchedSystem) -> list[Norm]:
    """Return the norm of every step of a round; what is not touched has no deflection."""
    norms = [quadratic_norm(Q) for Q in scaled_matrices(*evidence.functions)]
    return norms if system.contact is None else [clipped(norm) for norm in norms]


def _slowest(system: SwitchedSystem, norms: list[Norm]) -> Array:
    """Return the state in contact, among some, that keeps the most over a round."""
    rng, size = np.random.default_rng(0), len(norms)
    directions = rng.standard_normal((_DIRECTIONS, system.order)) / norms[0](np.eye(system.order))
    directions[:, -1] = np.abs(directions[:, -1])

    def kept(x: Array) -> float:
        return float(norms_in_rounds(worst_rounds(system, norms, x, size), norms)[-1])

    return max(directions, key=kept)
