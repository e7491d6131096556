"""One quadratic function per mode for contact and free motion: matrices, and a run that bounces."""

from __future__ import annotations

import numpy as np

from nrs_design.proof.evidence import ConewiseModeQuadratic
from nrs_design.reporting.document import Block, Illustration, Paragraph, Section
from nrs_design.reporting.figures.lyapunov import draw_quadratics
from nrs_design.reporting.kinds.shared.bouncing import bouncing_run
from nrs_design.reporting.kinds.shared.conewise import AbstractConewisePage
from nrs_design.reporting.kinds.shared.matrix import SCALED, matrix_table
from nrs_design.reporting.kinds.shared.run import trials_per_step
from nrs_design.reporting.sections.modes import hardest_modes
from nrs_design.reporting.sections.titles import EVIDENCE
from nrs_design.simulation.norms import Array, Norm, quadratic_norm, scaled_matrices
from nrs_design.simulation.switched import fine_step, sampled_direction

_TABLES = 2
_DRAWN = 6
# A run in the largest of many norms tries no more modes.
_MODES = 32


class ConewiseModeQuadraticPage(AbstractConewisePage[ConewiseModeQuadratic]):
    """The matrices of the modes in contact, and a run through contact and free motion."""

    function = (
        "Each mode has a function: x' Q x in contact, y' R y without the deflection in free "
        "motion. The largest of them decreases in every step."
    )
    decided = (
        "every matrix holds integers over a power of two, and integer arithmetic decides that each "
        "is positive definite and that every step, in contact, free, and from one to the other, "
        "decreases the functions, whatever mode comes next. The solver only proposed them"
    )

    @property
    def name(self) -> str:
        """Its kind."""
        return "quadratic function of each mode for contact and free motion"

    def sections(self, *, first: bool = True) -> tuple[Section, ...]:
        """Show the matrices of some modes in contact."""
        names = [name for name, _ in self.evidence.touching]
        matrices = dict(zip(names, self._matrices()[0], strict=True))
        text = (
            f"The certificate holds one matrix Q for each of {len(names)} modes in contact, one R "
            f"for each of {len(self.evidence.flying)} modes of free motion, and a multiplier for "
            "the latter. Modes that differ only by an enclosed number have equal matrices. They "
            f"are written with denominator 2^{self.evidence.denominator_log2}; here all are "
            "divided by the largest entry of any."
        )
        blocks: list[Block] = [Paragraph(text)]
        for name in names[:_TABLES]:
            blocks += matrix_table(f"Q of mode {name}", matrices[name], self.system.states)
        some = f" The first {_DRAWN} of {len(names)} modes." if len(names) > _DRAWN else ""
        drawn = {name: matrices[name] for name in names[:_DRAWN]}
        blocks.append(
            Illustration(
                "quadratics",
                "Matrices of the functions in contact",
                f"{SCALED}{some}",
                draw_quadratics(drawn, self.system.states),
            )
        )
        return (Section(EVIDENCE, tuple(blocks)),)

    def run(self) -> Section:
        """Draw a run in the largest of the functions, below its bound, and when contact is lost."""
        hardest = hardest_modes(self.system, None, min(trials_per_step(self.system), _MODES))
        norm = largest_norm(*self._matrices())
        return bouncing_run(
            self.system,
            hardest,
            norm,
            sampled_direction(hardest, norm, fine_step(hardest)),
            float(self.evidence.rate),
            "(largest norm)",
        )

    def _matrices(self) -> tuple[list[Array], list[Array]]:
        """Return the Q and the R, all divided by the largest entry of any."""
        touching = [Q for _, Q in self.evidence.touching]
        flying = [R for _, R in self.evidence.flying]
        scaled = scaled_matrices(*touching, *flying)
        return scaled[: len(touching)], scaled[len(touching) :]


def largest_norm(touching: list[Array], flying: list[Array]) -> Norm:
    """Return the largest ``sqrt(x' Q x)`` of states in contact, and ``sqrt(y' R y)`` of others.

    Parameters
    ----------
    touching, flying : list of ndarray
        The Q, and the R.
    """
    outer, inner = [list(map(quadratic_norm, part)) for part in (touching, flying)]

    def norm(states: Array) -> Array:
        contact = np.max([of(states) for of in outer], axis=0)
        free = np.max([of(states[..., :-1]) for of in inner], axis=0)
        return np.asarray(np.where(states[..., -1] > 0, contact, free))

    return norm
