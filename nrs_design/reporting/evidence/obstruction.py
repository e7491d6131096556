"""Why no common quadratic function exists: the weights of the contradiction."""

from __future__ import annotations

from nrs_design.reporting.document import Paragraph, Section, Table
from nrs_design.reporting.evidence.page import AbstractPage
from nrs_design.reporting.evidence.runs import unbounded_run
from nrs_design.reporting.formatting import number

_LISTED = 24
_MEANING = (
    "That no common quadratic function exists says nothing about stability: a function of another "
    "kind may exist."
)
_ARGUMENT = (
    "The certificate holds a positive semidefinite matrix X for some modes, such that the sum S of "
    "{term} over them is positive definite. If some Q > 0 decreased in every mode, then the trace "
    "of Q S would be positive, and equal to the sum of the traces of X ({decrease}), which is at "
    "most zero: a contradiction. A search for a common quadratic function can stop."
)


class ObstructionPage(AbstractPage):
    """The argument, and the modes that contradict each other."""

    name = "no common quadratic function exists"

    def meaning(self) -> tuple[str, ...]:
        """Say that it decides nothing about stability."""
        return (_MEANING,)

    def sections(self, *, first: bool = True) -> tuple[Section, ...]:
        """Say why there is none, and which modes contradict each other."""
        term, decrease = ("A X + X A'", "A'Q + QA")
        if self.is_discrete:
            term, decrease = ("A X A' - X", "A'QA - Q")
        text = f"{_ARGUMENT.format(term=term, decrease=decrease)} {_MEANING}"
        weights = self.offer.weights
        rows = tuple((name, number(float(share), 4)) for name, share in weights[:_LISTED])
        some = f", the {_LISTED} heaviest" if len(weights) > _LISTED else ""
        left_out = len(self.system.modes) - len(weights)
        none = f"; {left_out} modes have no part in it" if left_out else ""
        title = f"Weight of the modes in the contradiction{some}{none}"
        table = Table(title, ("Mode", "Share of the trace of X [1]"), rows)
        return (Section("No common quadratic function", (Paragraph(text), table)),)

    def run(self) -> Section:
        """Draw a run without a bound: nothing is shown about stability."""
        return unbounded_run(self.system)
