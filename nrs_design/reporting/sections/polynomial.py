"""A common polynomial function: its size, and how it decreases in every mode."""

from __future__ import annotations

from nrs_design.proof.evidence import CommonPolynomial
from nrs_design.proof.system import SwitchedSystem, Time
from nrs_design.reporting.document import Paragraph, Section, Table
from nrs_design.reporting.formatting import number
from nrs_design.reporting.sections.rates import rate_blocks
from nrs_design.simulation.rates import polynomial_rates


def polynomial_section(system: SwitchedSystem, evidence: CommonPolynomial) -> Section:
    """Show the size of the function and how every mode decreases it."""
    degree, count = 2 * evidence.degree, len(evidence.Q)
    bits = max(abs(entry).bit_length() for row in evidence.Q for entry in row)
    rows = (
        ("Degree of V", str(degree)),
        (f"Monomials of degree {evidence.degree} in {system.order} states", number(count, 9)),
        ("Longest entry of Q [bit]", str(bits)),
    )
    text = (
        f"The certificate holds a homogeneous polynomial V(x) = z' Q z of degree {degree}, z being "
        f"all monomials of degree {evidence.degree} in the states. For every mode it holds a form "
        "in z that vanishes identically; added to the decrease of V, it makes a positive definite "
        "matrix. Its level curves need not be ellipses, which is what a quadratic function lacks."
    )
    norm = f"V^(1/{degree})"
    return Section(
        "Lyapunov evidence",
        (
            Paragraph(text),
            Table("The polynomial", ("", "Value"), rows),
            *rate_blocks(
                system,
                polynomial_rates(system, evidence),
                evidence.rate,
                norm,
                _explained(norm, system.time),
            ),
        ),
    )


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
