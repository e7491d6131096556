"""Why no common quadratic function exists: the weights of the contradiction."""

from __future__ import annotations

from fractions import Fraction

from nrs_design.proof.evidence import NoCommonQuadratic
from nrs_design.proof.mode import Time
from nrs_design.reporting.document import Paragraph, Section, Table
from nrs_design.reporting.formatting import number
from nrs_design.reporting.kinds.abstract import AbstractKindPage
from nrs_design.reporting.kinds.shared.run import unbounded_run

_LISTED = 24


class NoCommonQuadraticPage(AbstractKindPage[NoCommonQuadratic]):
    """The argument, and the modes that contradict each other."""

    @property
    def name(self) -> str:
        """What it shows."""
        return "no common quadratic function exists"

    def meaning(self) -> tuple[str, ...]:
        """Say that it decides nothing about stability."""
        return (
            "That no common quadratic function exists says nothing about stability: a function of "
            "another kind may exist.",
        )

    def limits(self) -> tuple[str, ...]:
        """Say nothing: its meaning is its limit."""
        return ()

    def sections(self, *, first: bool = True) -> tuple[Section, ...]:
        """Say why there is none, and which modes contradict each other."""
        if self.system.time is Time.CONTINUOUS:
            term, decrease = "A X + X A'", "A'Q + QA"
        else:
            term, decrease = "A X A' - X", "A'QA - Q"
        text = (
            "The certificate holds a positive semidefinite matrix X for some modes, such that the "
            f"sum S of {term} over them is positive definite. If some Q > 0 decreased in every "
            "mode, then the trace of Q S would be positive, and equal to the sum of the traces of "
            f"X ({decrease}), which is at most zero: a contradiction. Whoever looks for a "
            "quadratic function can stop. It says nothing about stability: a function of another "
            "kind may exist."
        )
        return (Section("No common quadratic function", (Paragraph(text), self._weights())),)

    def run(self) -> Section:
        """Draw a run without a bound: nothing is shown about stability."""
        return unbounded_run(self.system)

    def _weights(self) -> Table:
        traces = {n: sum(v * v for row in L for v in row) for n, L in self.evidence.factors}
        total = sum(traces.values())
        heaviest = sorted(traces, key=lambda name: -traces[name])[:_LISTED]
        rows = tuple((name, number(float(Fraction(traces[name], total)), 4)) for name in heaviest)
        left_out = len(self.system.modes) - len(traces)
        some = f", the {_LISTED} heaviest" if len(traces) > _LISTED else ""
        none = f"; {left_out} modes have no part in it" if left_out else ""
        title = f"Weight of the modes in the contradiction{some}{none}"
        return Table(title, ("Mode", "Share of the trace of X [1]"), rows)
