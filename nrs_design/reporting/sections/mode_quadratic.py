"""One quadratic function per mode: their matrices."""

from __future__ import annotations

import math
from fractions import Fraction

from nrs_design.certificates.evidence import ModeQuadratic
from nrs_design.reporting.document import Block, Illustration, Paragraph, Section
from nrs_design.reporting.figures.lyapunov import draw_quadratics
from nrs_design.reporting.formatting import shortened
from nrs_design.reporting.sections.quadratic import SCALED, matrix_table
from nrs_design.simulation.admissible import norm_ratio
from nrs_design.simulation.norms import mode_functions
from nrs_design.spec.bounds import at_most
from nrs_design.switched.system import SwitchedSystem, Time

_TABLES = 4
_DRAWN = 6
_NAMED = 8


def except_left(evidence: ModeQuadratic) -> str:
    """Say in which modes the function need not decrease."""
    if not evidence.leaving:
        return ""
    return f" (but in {shortened(evidence.leaving, _NAMED)}, which must be left, it may grow)"


def mode_quadratic_section(system: SwitchedSystem, evidence: ModeQuadratic) -> Section:
    """Show the matrix of every mode."""
    functions = mode_functions(evidence)
    decay = "exp(-alpha t)" if system.time is Time.CONTINUOUS else "rho^t"
    c = norm_ratio(functions)
    size = f"{at_most(Fraction(c))} (floating point)" if math.isfinite(c) else "beyond floats"
    text = (
        "The certificate holds one matrix Q for each mode. While a mode is active, its function "
        f"x' Q x decreases at the claimed rate{except_left(evidence)}; when the next mode takes "
        "over, the value of its function is below what the bound allows since the last switch. "
        "The matrices are written "
        f"with denominator 2^{evidence.denominator_log2}; here all are divided by the largest "
        "entry of any."
    )
    if not evidence.leaving:
        text += (
            " In the Euclidean norm of the states, in their units, the bound is c "
            f"{decay} with c {size}."
        )
    blocks: list[Block] = [Paragraph(text)]
    for name, Q in list(functions.items())[:_TABLES]:
        blocks += matrix_table(f"Q of mode {name}", Q, system.states)
    drawn = dict(list(functions.items())[:_DRAWN])
    some = f" The first {_DRAWN} of {len(functions)} modes." if len(functions) > _DRAWN else ""
    blocks.append(
        Illustration(
            "quadratics",
            "Matrices of the modes' functions",
            f"{SCALED}{some}",
            draw_quadratics(drawn, system.states),
        )
    )
    return Section("Lyapunov evidence", tuple(blocks))
