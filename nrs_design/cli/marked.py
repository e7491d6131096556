"""A row for every impedance controller, with marks beside what is doubtful."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

from nrs_design.design.measures import MARGINS
from nrs_design.proof.bounds import lower

if TYPE_CHECKING:
    from nrs_design.design.analysis import ImpedanceAnalysis


def cells(item: ImpedanceAnalysis) -> list[str]:
    """Return the cells of a controller; `marks` says what the marks mean."""
    return [
        item.name,
        f"{item.Mt:.6g}{'*' * ('Mt' in item.on_bound)}",
        f"{item.Bt:.6g}{'*' * ('Bt' in item.on_bound)}",
        f"{item.cost:.4f}",
        *(f"{item.shown(measure).text}{'!' * (measure in item.unusual)}" for measure in MARGINS),
        _limits(item),
    ]


def worst_of(items: Sequence[ImpedanceAnalysis]) -> str:
    """Say over what the margins of a table are the worst."""
    if all(
        one.proved is not None or one.everywhere for i in items for one in map(i.shown, MARGINS)
    ):
        return "the worst over all ranges"
    return "the worst at the corners of all ranges"


def basis(items: Sequence[ImpedanceAnalysis]) -> str:
    """Say which margins are proved of all controllers, and what the others are."""
    proved = [m.title for m in MARGINS if all(m.title in item.proved_titles for item in items)]
    if not proved:
        return "Margins: floating point at the corners of all ranges, not a proof (-v says more)."
    shown = "all margins" if len(proved) == len(MARGINS) else ", ".join(proved)
    return f"Proved over all values of the ranges: {shown}; the rest is floating point (-v)."


def marks(items: Iterable[ImpedanceAnalysis]) -> Iterator[str]:
    """Yield what the marks mean, as far as there are any."""
    items = tuple(items)
    if any(item.on_bound for item in items):
        yield "* on its bound: the range of the spec has chosen it, not the cost"
    found = [m for m in MARGINS if any(m in item.unusual for item in items)]
    if found:
        said = ", ".join(f"{measure.title} {measure.usual}" for measure in found)
        yield f"! not as usual ({said}); a goal says what is accepted"


def _limits(item: ImpedanceAnalysis) -> str:
    """Return the stiffness that the loop stands up to, and the same where it is touched."""
    at_arm = item.limit_at_arm
    beside = ""
    if at_arm is not None and math.isfinite(at_arm):
        beside = f"\n{_limit(at_arm)} N/m at {item.lever_arm:g} m"
    return f"{_limit(item.lowest_limit)}{beside}"


def _limit(value: float) -> str:
    """Write a limit of stiffness, rounded down."""
    if math.isnan(value):
        return "not computed"
    return "unlimited" if math.isinf(value) else lower(Fraction(value), 4)
