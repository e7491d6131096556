"""A common polynomial function: its size, and how it decreases in every mode."""

from __future__ import annotations

import numpy as np

from nrs_design.proof.evidence import CommonPolynomial
from nrs_design.proof.evidence.common_polynomial import lifted_decrease, lifted_factor
from nrs_design.proof.exact import add
from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.reporting.document import Paragraph, Section, Table
from nrs_design.reporting.formatting import number
from nrs_design.reporting.kinds.abstract import AbstractKindPage
from nrs_design.reporting.kinds.shared import words
from nrs_design.reporting.kinds.shared.rates import rate_blocks
from nrs_design.reporting.kinds.shared.run import bounded_run, trials_per_step
from nrs_design.reporting.sections.modes import hardest_modes
from nrs_design.reporting.sections.titles import EVIDENCE
from nrs_design.simulation.norms import Array, diagonal_exponents, polynomial_norm, scaled_form
from nrs_design.simulation.switched import fine_step, sampled_direction

_DECIDED = (
    "Q and the forms that vanish hold integers, and integer arithmetic decides that Q is "
    "positive definite in the monomials and that V decreases in every mode. The solver only "
    "proposed them"
)
# A run in a polynomial's norm tries no more modes.
_MODES = 32
_NESTED = (1.0, 0.75, 0.5, 0.25)


class CommonPolynomialPage(AbstractKindPage[CommonPolynomial]):
    """The size of V, and the rate of every mode in its root."""

    @property
    def name(self) -> str:
        """Its kind and degree."""
        return f"polynomial of degree {2 * self.evidence.degree}"

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
        """Show the size of the function and how every mode decreases it."""
        system, evidence = self.system, self.evidence
        degree, count = 2 * evidence.degree, len(evidence.Q)
        bits = max(abs(entry).bit_length() for row in evidence.Q for entry in row)
        rows = (
            ("Degree of V", str(degree)),
            (f"Monomials of degree {evidence.degree} in {system.order} states", number(count, 9)),
            ("Longest entry of Q [bit]", str(bits)),
        )
        text = (
            f"The certificate holds a homogeneous polynomial V(x) = z' Q z of degree {degree}, z "
            f"being all monomials of degree {evidence.degree} in the states. For every mode it "
            "holds a form in z that vanishes identically; added to the decrease of V, it makes a "
            "positive definite matrix. Its level curves need not be ellipses, which is what a "
            "quadratic function lacks."
        )
        norm, rates = f"V^(1/{degree})", polynomial_rates(system, evidence)
        blocks = (
            Paragraph(text),
            Table("The polynomial", ("", "Value"), rows),
            *rate_blocks(system, rates, evidence.rate, norm, _explained(norm, system.time)),
        )
        return (Section(EVIDENCE, blocks),)

    def run(self) -> Section:
        """Draw a run in the root of V, below its bound."""
        system, evidence = self.system, self.evidence
        hardest = hardest_modes(system, None, min(trials_per_step(system), _MODES))
        norm = polynomial_norm(evidence.Q, evidence.degree, system.order)
        return bounded_run(
            system,
            hardest,
            norm,
            sampled_direction(hardest, norm, fine_step(hardest)),
            float(evidence.rate),
            f"in V^(1/{2 * evidence.degree})",
            levels=_NESTED,
        )


def polynomial_rates(system: SwitchedSystem, evidence: CommonPolynomial) -> Array:
    """Return the rate that the certificate's own numbers would prove for every mode alone.

    Returns
    -------
    ndarray, shape (m,)
        Decay rates in 1/s, or contractions per step, of ``V^(1/2d)``, in floating point.
    """
    exponents = diagonal_exponents(evidence.Q)
    inverse = np.linalg.inv(np.linalg.cholesky(scaled_form(evidence.Q, exponents)))
    d, rate = evidence.degree, float(evidence.rate)
    slack = []
    for mode, N in zip(system.modes, evidence.vanishing, strict=True):
        form = add(lifted_decrease(mode, d, evidence.Q, evidence.rate, system.time), N)
        factor = lifted_factor(mode, d, evidence.rate, system.time)
        relative = inverse @ scaled_form(form, exponents, factor) @ inverse.T
        slack.append(float(np.linalg.eigvalsh(relative)[0]))
    if system.time is Time.CONTINUOUS:
        return rate + np.array(slack) / (2 * d)
    return np.asarray(np.maximum(rate ** (2 * d) - np.array(slack), 0.0) ** (1 / (2 * d)))


def _explained(norm: str, time: Time) -> str:
    if time is Time.CONTINUOUS:
        return (
            f"The rate at which {norm} decays at least in this mode, as far as the certificate's "
            "own numbers show it (smallest eigenvalue of the decrease relative to Q)."
        )
    return (
        f"The factor by which {norm} shrinks at least in a step of this mode, as far as the "
        "certificate's own numbers show it."
    )
