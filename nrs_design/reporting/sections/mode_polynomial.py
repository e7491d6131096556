"""One polynomial function per mode: their size."""

from __future__ import annotations

from nrs_design.certificates.evidence import ModePolynomial
from nrs_design.reporting.document import Paragraph, Section, Table
from nrs_design.reporting.formatting import number
from nrs_design.switched.system import SwitchedSystem


def mode_polynomial_section(system: SwitchedSystem, evidence: ModePolynomial) -> Section:
    """Show the size of the functions."""
    degree, functions = 2 * evidence.degree, evidence.quadratic.functions
    bits = max(abs(entry).bit_length() for _, Q in functions for row in Q for entry in row)
    rows = (
        ("Degree of every V", str(degree)),
        ("Functions, one for each mode", number(len(functions), 9)),
        (
            f"Monomials of degree {evidence.degree} in {system.order} states",
            number(max(len(Q) for _, Q in functions), 9),
        ),
        ("Decreases, in modes and at switches", number(len(evidence.vanishing), 9)),
        ("Longest entry of any Q [bit]", str(bits)),
    )
    text = (
        f"The certificate holds a homogeneous polynomial V(x) = z' Q z of degree {degree} for each "
        f"mode, z being all monomials of degree {evidence.degree} in the states. From one switch "
        "to the next, the value of the active function falls below what the bound allows. For "
        "every decrease it holds a form in z that vanishes identically; added to the decrease, it "
        "makes a positive definite matrix."
    )
    blocks = (Paragraph(text), Table("The polynomials", ("", "Value"), rows))
    return Section("Lyapunov evidence", blocks)
