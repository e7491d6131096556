"""Why no common quadratic function exists: the weights of the contradiction."""

from __future__ import annotations

from fractions import Fraction

from nrs_design.proof.evidence import NoCommonQuadratic
from nrs_design.proof.system import SwitchedSystem, Time
from nrs_design.reporting.document import Block, Paragraph, Section, Table
from nrs_design.reporting.formatting import number

_LISTED = 24


def no_common_quadratic_section(system: SwitchedSystem, evidence: NoCommonQuadratic) -> Section:
    """Say why there is none, and which modes contradict each other."""
    return Section("No common quadratic function", obstruction_blocks(system, evidence))


def obstruction_blocks(system: SwitchedSystem, evidence: NoCommonQuadratic) -> tuple[Block, ...]:
    """Return the argument in words and the weights of the modes."""
    if system.time is Time.CONTINUOUS:
        term, decrease = "A X + X A'", "A'Q + QA"
    else:
        term, decrease = "A X A' - X", "A'QA - Q"
    text = (
        "The certificate holds a positive semidefinite matrix X for some modes, such that the sum "
        f"S of {term} over them is positive definite. If some Q > 0 decreased in every mode, then "
        f"the trace of Q S would be positive, and equal to the sum of the traces of X ({decrease}),"
        " which is at most zero: a contradiction. Whoever looks for a quadratic function can stop. "
        "It says nothing about stability: a function of another kind may exist."
    )
    return Paragraph(text), _table(system, evidence)


def _table(system: SwitchedSystem, evidence: NoCommonQuadratic) -> Table:
    traces = {name: sum(v * v for row in L for v in row) for name, L in evidence.factors}
    total = sum(traces.values())
    heaviest = sorted(traces, key=lambda name: -traces[name])[:_LISTED]
    rows = tuple((name, number(float(Fraction(traces[name], total)), 4)) for name in heaviest)
    left_out = len(system.modes) - len(traces)
    some = f", the {_LISTED} heaviest" if len(traces) > _LISTED else ""
    none = f"; {left_out} modes have no part in it" if left_out else ""
    title = f"Weight of the modes in the contradiction{some}{none}"
    return Table(title, ("Mode", "Share of the trace of X [1]"), rows)
