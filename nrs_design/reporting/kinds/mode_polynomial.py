"""One polynomial function per mode: their size, and a run that keeps the rules."""

from __future__ import annotations

from nrs_design.proof.evidence import ModePolynomial
from nrs_design.reporting.document import Illustration, Paragraph, Section, Table
from nrs_design.reporting.figures.run import draw_run
from nrs_design.reporting.formatting import number
from nrs_design.reporting.kinds.abstract import AbstractKindPage
from nrs_design.reporting.kinds.shared import words
from nrs_design.reporting.kinds.shared.run import (
    BESIDE,
    EUCLIDEAN,
    RULED,
    bound_line,
    euclidean,
    phase_plane,
    ruled_run,
    simulated,
    some_modes,
)
from nrs_design.reporting.sections.titles import EVIDENCE

_DECIDED = (
    "every Q and every form that vanishes hold integers, and integer arithmetic decides that "
    "each Q is positive definite in the monomials, that its polynomial decreases in its mode, "
    "and that no admissible switch raises the function. The solver only proposed them"
)


class ModePolynomialPage(AbstractKindPage[ModePolynomial]):
    """The size of the modes' functions."""

    @property
    def name(self) -> str:
        """Its kind and degree."""
        return f"polynomial of degree {2 * self.evidence.degree} of each mode"

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
        """Show the size of the functions."""
        evidence, functions = self.evidence, self.evidence.quadratic.functions
        bits = max(abs(entry).bit_length() for _, Q in functions for row in Q for entry in row)
        rows = (
            ("Degree of every V", str(2 * evidence.degree)),
            ("Functions, one for each mode", number(len(functions), 9)),
            (
                f"Monomials of degree {evidence.degree} in {self.system.order} states",
                number(max(len(Q) for _, Q in functions), 9),
            ),
            ("Decreases, in modes and at switches", number(len(evidence.vanishing), 9)),
            ("Longest entry of any Q [bit]", str(bits)),
        )
        text = (
            "The certificate holds a homogeneous polynomial V(x) = z' Q z of degree "
            f"{2 * evidence.degree} for each mode, z being all monomials of degree "
            f"{evidence.degree} in the states. From one switch to the next, the value of the "
            "active function falls below what the bound allows. For every decrease it holds a "
            "form in z that vanishes identically; added to the decrease, it makes a positive "
            "definite matrix."
        )
        blocks = (Paragraph(text), Table("The polynomials", ("", "Value"), rows))
        return (Section(EVIDENCE, blocks),)

    def run(self) -> Section:
        """Draw a run that keeps the rules in the Euclidean norm, beside the slope of its bound."""
        system, rate = self.system, float(self.evidence.quadratic.rate)
        hardest, response, norms = ruled_run(system, euclidean(system), rate)
        slope = bound_line(response, rate, system.time, "slope of the proved bound, ")
        run = Illustration(
            "run",
            BESIDE,
            f"{RULED} The dashed line has the proved rate. The certificate says that every run "
            "that keeps the rules stays below such a line, up to one constant factor; so this run "
            f"may lie above the line for a while.{some_modes(system, hardest)}",
            draw_run(response, norms, slope, hardest, EUCLIDEAN),
        )
        return simulated(run, *phase_plane(hardest, response, None))
