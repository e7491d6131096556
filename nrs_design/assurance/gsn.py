"""Elements of the Goal Structuring Notation, as its community standard (version 3) defines them.

An argument is a tree here: what supports two elements is drawn twice, under two ids.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum


class GsnKind(StrEnum):
    """What an element is."""

    GOAL = "goal"
    STRATEGY = "strategy"
    SOLUTION = "solution"
    CONTEXT = "context"
    ASSUMPTION = "assumption"
    JUSTIFICATION = "justification"


# What may support what; a solution is supported by nothing.
MAY_SUPPORT = {
    GsnKind.GOAL: (GsnKind.GOAL, GsnKind.STRATEGY, GsnKind.SOLUTION),
    GsnKind.STRATEGY: (GsnKind.GOAL,),
}
IN_CONTEXT = (GsnKind.CONTEXT, GsnKind.ASSUMPTION, GsnKind.JUSTIFICATION)


@dataclass(frozen=True, slots=True)
class GsnElement:
    """One element, with all that supports it and the context that it is in."""

    id: str  # Such as ``G3.1``
    kind: GsnKind
    text: str
    supported_by: tuple[GsnElement, ...] = ()
    in_context_of: tuple[GsnElement, ...] = ()
    refuted: bool = False  # Whether something shows that it does not hold

    @property
    def undeveloped(self) -> bool:
        """Whether nothing supports what needs support."""
        return self.kind in MAY_SUPPORT and not self.supported_by

    def walk(self) -> Iterator[GsnElement]:
        """Yield it and all elements below it, from top to bottom."""
        yield self
        for element in (*self.in_context_of, *self.supported_by):
            yield from element.walk()


def goal(id: str, text: str, *support: GsnElement, refuted: bool = False) -> GsnElement:
    """Return a goal with what supports it.

    Parameters
    ----------
    id, text : str
        Of the goal.
    *support : GsnElement
        Goals, one strategy, or solutions.
    refuted : bool
        Whether something shows that it does not hold.
    """
    return GsnElement(id, GsnKind.GOAL, text, support, (), refuted)


def solution(id: str, text: str) -> GsnElement:
    """Return a solution: where the evidence is."""
    return GsnElement(id, GsnKind.SOLUTION, text)


def render_text(top: GsnElement) -> str:
    """Return an argument as an outline: what supports an element stands below it, indented."""
    return "\n".join(_outline(top, "")) + "\n"


def _outline(element: GsnElement, indent: str) -> Iterator[str]:
    marks = " [undeveloped]" if element.undeveloped else ""
    marks += " [REFUTED]" if element.refuted else ""
    yield f"{indent}{element.id} ({element.kind}){marks}: {element.text}"
    for context in element.in_context_of:
        yield f"{indent}    in context of {context.id} ({context.kind}): {context.text}"
    for support in element.supported_by:
        yield from _outline(support, f"{indent}  ")
