"""Evidence for several constant parameters: forms at the corners of their ranges, and a run."""

from __future__ import annotations

from dataclasses import replace

from nrs_design.reporting.document import Paragraph, Section
from nrs_design.reporting.evidence import words
from nrs_design.reporting.evidence.norms import matrix_blocks
from nrs_design.reporting.evidence.page import AbstractPage
from nrs_design.reporting.evidence.runs import Greedy, bounded_run, trials_per_step
from nrs_design.reporting.sections.modes import hardest_modes
from nrs_design.reporting.sections.titles import EVIDENCE
from nrs_design.simulation.norms import modes_at_corner, quadratic_norm, scaled_matrices
from nrs_design.simulation.rates import mode_rates
from nrs_design.simulation.switched import worst_direction


class ConstantsPage(AbstractPage):
    """P at every corner of the constant parameters."""

    name = "quadratic function of constant parameters"

    def meaning(self) -> tuple[str, ...]:
        """Say that the parameters must be constant, and that switching is free."""
        return (
            f"{words.free_bound(self.system)} Which norm |x| is, depends on the values of the "
            "constant parameters.",
            "These parameters must be constant: one value each in all modes and at all times. "
            "Which values, need not be known. With two more matrices for each mode the condition "
            "is affine in what depends on them, so the corners of their ranges decide for all "
            "values between.",
            *words.unneeded_rules(self.system),
            words.decision(self.system),
        )

    def between_corners(self) -> str:
        """Say that they are covered, for the other parameters while they change."""
        how = "however fast they change, the constant ones excepted"
        return words.all_corners(self.system, self.evidence, how)

    def limits(self) -> tuple[str, ...]:
        """Name the parameters that change."""
        return ("A constant parameter that changes while the system moves, however slowly.",)

    def sections(self, *, first: bool = True) -> tuple[Section, ...]:
        """Show P at all corners."""
        text = (
            "The certificate holds P at the corners of the constant parameters, and two more "
            "matrices for each mode, which are not shown. They are written with denominator "
            f"2^{self.offer.denominator_log2}; here all P are divided by the largest entry."
        )
        matrices = matrix_blocks(self.offer.forms, self.system.states)
        return (Section(EVIDENCE, (Paragraph(text), *matrices)),)

    def run(self) -> Section:
        """Draw a run at the corner where the decay is slowest."""
        forms = scaled_matrices(*(form.Q for form in self.offer.forms))
        corners = [modes_at_corner(self.system, k) for k in range(len(forms))]
        slowest = max if self.is_discrete else min
        rates = [slowest(mode_rates(at, P)) for at, P in zip(corners, forms, strict=True)]
        k = rates.index(slowest(rates))
        fixed, P = corners[k], forms[k]
        hardest = replace(hardest_modes(fixed, P, trials_per_step(fixed)), contact=None)
        proved = self.evidence.proved_rate(self.system)
        assert proved is not None  # it shows stability
        return bounded_run(
            Greedy(fixed, hardest, quadratic_norm(P), worst_direction(hardest, P), float(proved)),
            "in the norm of P at this corner",
            f"The constant parameters stay at corner {k + 1}, where the decay is slowest.",
        )
