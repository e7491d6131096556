"""One quadratic function per mode: their matrices, and a run that keeps the rules."""

from __future__ import annotations

import math
from fractions import Fraction

from nrs_design.proof.bounds import at_most
from nrs_design.proof.evidence import ModeQuadratic
from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.reporting.document import Block, Illustration, Paragraph, Section
from nrs_design.reporting.figures.lyapunov import draw_quadratics
from nrs_design.reporting.figures.run import draw_mode_levels, draw_run
from nrs_design.reporting.formatting import shortened
from nrs_design.reporting.kinds.abstract import AbstractKindPage
from nrs_design.reporting.kinds.shared import words
from nrs_design.reporting.kinds.shared.matrix import SCALED, matrix_table
from nrs_design.reporting.kinds.shared.run import (
    AGAINST,
    PATH,
    RULED,
    bound_line,
    jumps,
    plane_axes,
    ruled_run,
    simulated,
    some_modes,
)
from nrs_design.reporting.sections.titles import EVIDENCE
from nrs_design.simulation.admissible import norm_ratio
from nrs_design.simulation.norms import Array, quadratic_norm, scaled_matrices
from nrs_design.simulation.switched import SwitchedRun

_DECIDED = (
    "every Q holds integers over a power of two, and integer arithmetic decides that each is "
    "positive definite, that it decreases in its mode if that may last, and that no admissible "
    "switch raises the function. The solver only proposed them"
)
_TABLES = 4
_DRAWN = 6


class ModeQuadraticPage(AbstractKindPage[ModeQuadratic]):
    """The matrices of the modes."""

    @property
    def name(self) -> str:
        """Its kind."""
        return "quadratic function of each mode"

    def meaning(self) -> tuple[str, ...]:
        """Say that it rests on the declared rules."""
        return (
            words.ruled_bound(self.system),
            *words.needed_rules(self.system, self.evidence.leaving),
            words.ruled_decision(self.system, _DECIDED),
        )

    def between_corners(self) -> tuple[str, ...]:
        """Say that they are covered."""
        return (words.all_corners(self.system, self.evidence),)

    def limits(self) -> tuple[str, ...]:
        """Name the signals that break the rules."""
        return tuple(words.outside_the_rules(self.system, self.evidence.leaving))

    def sections(self, *, first: bool = True) -> tuple[Section, ...]:
        """Show the matrix of every mode."""
        functions, states = self._functions(), self.system.states
        blocks: list[Block] = [Paragraph(self._text(functions))]
        for name, Q in list(functions.items())[:_TABLES]:
            blocks += matrix_table(f"Q of mode {name}", Q, states)
        drawn = dict(list(functions.items())[:_DRAWN])
        some = f" The first {_DRAWN} of {len(functions)} modes." if len(functions) > _DRAWN else ""
        blocks.append(
            Illustration(
                "quadratics",
                "Matrices of the modes' functions",
                f"{SCALED}{some}",
                draw_quadratics(drawn, states),
            )
        )
        return (Section(EVIDENCE, tuple(blocks)),)

    def run(self) -> Section:
        """Draw a run in the norm of the active mode, below its bound."""
        functions, rate = self._functions(), float(self.evidence.rate)
        hardest, response, norms = ruled_run(self.system, functions, rate)
        bound = bound_line(response, rate, self.system.time, "proved bound, ")
        run = Illustration(
            "run",
            AGAINST,
            f"{RULED} Drawn is the root of V of the active mode, over its start. Where the next "
            "mode takes over, it may jump, but it stays below the dashed bound of the "
            "certificate, which holds for every signal that keeps the rules. In a norm that is "
            f"the same in all modes, the bound holds with the factor c.{_rises(self.evidence)}"
            f"{some_modes(self.system, hardest)}",
            draw_run(response, norms, bound, hardest, "Root of V of the active mode [1]"),
        )
        return simulated(run, *self._plane(hardest, response, functions))

    def _functions(self) -> dict[str, Array]:
        """Return the matrix of every mode, all divided by the largest entry of all."""
        matrices = scaled_matrices(*(Q for _, Q in self.evidence.functions))
        names = [name for name, _ in self.evidence.functions]
        return dict(zip(names, matrices, strict=True))

    def _text(self, functions: dict[str, Array]) -> str:
        """Say what the certificate holds, and how large the constant of the bound is."""
        evidence = self.evidence
        text = (
            "The certificate holds one matrix Q for each mode. While a mode is active, its "
            f"function x' Q x decreases at the claimed rate{_except_left(evidence)}; when the "
            "next mode takes over, the value of its function is below what the bound allows "
            "since the last switch. The matrices are written with denominator "
            f"2^{evidence.denominator_log2}; here all are divided by the largest entry of any."
        )
        if evidence.leaving:
            return text
        decay = "exp(-alpha t)" if self.system.time is Time.CONTINUOUS else "rho^t"
        c = norm_ratio(functions)
        size = f"{at_most(Fraction(c))} (floating point)" if math.isfinite(c) else "beyond floats"
        return (
            f"{text} In the Euclidean norm of the states, in their units, the bound is c "
            f"{decay} with c {size}."
        )

    def _plane(
        self, hardest: SwitchedSystem, response: SwitchedRun, functions: dict[str, Array]
    ) -> tuple[Illustration, ...]:
        """Draw the run among level curves of the modes' functions, if there are two states."""
        system = self.system
        if system.order != 2 or not system.is_uniform:
            return ()
        roots = {name: quadratic_norm(Q) for name, Q in functions.items()}
        illustration = Illustration(
            "phase-plane",
            "The same run in the plane of the two states",
            f"{PATH} {plane_axes(system)} Dashed is a level curve of each mode's own function, "
            "all at one value. While a mode is active, its own function decreases"
            + (", except in a mode that must be left." if self.evidence.leaving else ".")
            + jumps(system),
            draw_mode_levels(response, hardest, roots),
        )
        return (illustration,)


def _except_left(evidence: ModeQuadratic) -> str:
    """Say in which modes the function need not decrease."""
    if not evidence.leaving:
        return ""
    left = shortened(evidence.leaving, words.NAMED)
    return f" (but in {left}, which must be left, it may grow)"


def _rises(evidence: ModeQuadratic) -> str:
    if not evidence.leaving:
        return ""
    return (
        " In a mode that must be left it may rise above the bound; at the next switch it is below."
    )
