"""One polynomial for contact and free motion: its size, and a run that bounces."""

from __future__ import annotations

from nrs_design.proof.evidence import ConewisePolynomial
from nrs_design.reporting.document import Paragraph, Section, Table
from nrs_design.reporting.formatting import number
from nrs_design.reporting.kinds.common_polynomial import polynomial_rates
from nrs_design.reporting.kinds.shared.bouncing import bouncing_run
from nrs_design.reporting.kinds.shared.conewise import AbstractConewisePage
from nrs_design.reporting.kinds.shared.rates import rate_blocks
from nrs_design.reporting.kinds.shared.run import trials_per_step
from nrs_design.reporting.sections.modes import hardest_modes
from nrs_design.reporting.sections.titles import EVIDENCE
from nrs_design.simulation.contact import clipped
from nrs_design.simulation.norms import polynomial_norm
from nrs_design.simulation.switched import fine_step, sampled_direction

_RATES = (
    "How fast the root of V decays at least in each mode in contact, as far as the certificate's "
    "own numbers show it. Free motion has conditions of its own, on the other states."
)
# A run in a polynomial's norm tries no more modes.
_MODES = 32


class ConewisePolynomialPage(AbstractConewisePage[ConewisePolynomial]):
    """The size of V, the rate of every mode in its root, and a run through contact and flight."""

    function = (
        "The function is a polynomial V of all states in contact; in free motion the deflection is "
        "zero in it."
    )
    decided = (
        "Q and the forms that vanish hold integers, and integer arithmetic decides that Q is "
        "positive definite in the monomials and that V decreases in every mode in contact and in "
        "every mode of free motion. The solver only proposed them"
    )

    @property
    def name(self) -> str:
        """Its kind and degree."""
        degree = 2 * self.evidence.in_contact.degree
        return f"polynomial of degree {degree} for contact and free motion"

    def sections(self, *, first: bool = True) -> tuple[Section, ...]:
        """Show the size of the function and how every mode in contact decreases it."""
        system, V = self.system, self.evidence.in_contact
        degree = 2 * V.degree
        bits = max(abs(entry).bit_length() for row in V.Q for entry in row)
        rows = (
            ("Degree of V", str(degree)),
            (f"Monomials of degree {V.degree} in {system.order} states", number(len(V.Q), 9)),
            ("Those without the deflection", number(len(self.evidence.vanishing_free[0]), 9)),
            ("Longest entry of Q [bit]", str(bits)),
        )
        text = (
            f"The certificate holds a homogeneous polynomial V(w) = z' Q z of degree {degree}, z "
            f"being all monomials of degree {V.degree} in the states. For every mode, in contact "
            "and free, it holds a form in z that vanishes identically; added to the decrease of V, "
            "it makes a positive definite matrix. In free motion only the monomials without the "
            "deflection are left."
        )
        rates = polynomial_rates(system, V)
        blocks = (
            Paragraph(text),
            Table("The polynomial", ("", "Value"), rows),
            *rate_blocks(system, rates, V.rate, f"V^(1/{degree})", _RATES),
        )
        return (Section(EVIDENCE, blocks),)

    def run(self) -> Section:
        """Draw a run in the root of V, below its bound, and when contact is lost."""
        system, V = self.system, self.evidence.in_contact
        hardest = hardest_modes(system, None, min(trials_per_step(system), _MODES))
        norm = polynomial_norm(V.Q, V.degree, system.order)
        return bouncing_run(
            system,
            hardest,
            clipped(norm),
            sampled_direction(hardest, norm, fine_step(hardest)),
            float(V.rate),
            f"in V^(1/{2 * V.degree})",
        )
