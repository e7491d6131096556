"""Goals of a design, and what is achieved of them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from nrs_design.proof.bounds import lower_float, upper_float

if TYPE_CHECKING:
    from nrs_design.design.analysis import AbstractControllerAnalysis, ImpedanceAnalysis
    from nrs_design.design.goals import Achieved


def responses_summary(item: ImpedanceAnalysis) -> list[dict[str, Any]]:
    """Return the goals for frequency responses, and what is proved of them, in SI units."""
    return [
        {
            "goal": found.key,
            "wanted": found.wanted,
            "limit": float(found.limit),
            "at_most": None if found.above is None else upper_float(found.above),
            "at_least": None if found.below is None else lower_float(found.below),
            "unit": found.unit,
            "shown": found.said,
            "status": found.ends,
        }
        for found in item.responses
    ]


def goals_summary(item: AbstractControllerAnalysis) -> list[dict[str, Any]]:
    """Return everything that was measured, with its goal if there is one, in SI units."""
    return [_summary(found) for found in item.judged]


def _safe(found: Achieved) -> float | None:
    """Return what is proved, rounded to its unfavorable side."""
    if found.proved is None:
        return None
    return upper_float(found.proved) if found.measure.upper else lower_float(found.proved)


def _summary(found: Achieved) -> dict[str, Any]:
    measure = found.measure
    return {
        "goal": measure.goal,
        "wanted": found.goal,
        # JSON has no infinity: null is a margin that nothing limits, or an error without bound; or
        # what is not computed, as `at` then says.
        "worst": found.value if math.isfinite(found.value) else None,
        # What no constant values in the ranges are worse than; null is not shown.
        "proved": _safe(found),
        "unit": measure.si_unit,
        "at": found.where,
        "status": None if found.goal is None else str(found.standing),
    }
