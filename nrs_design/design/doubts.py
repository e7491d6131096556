"""Reasons to doubt a design that its spec does not exclude by a goal."""

from __future__ import annotations

import math
from collections.abc import Iterator

from nrs_design.controllers.controller_design import ImpedanceOptimum
from nrs_design.design.goals import Achieved
from nrs_design.design.measures import DISK_MARGIN, MARGINS, SENSITIVITY_PEAK
from nrs_design.spec import Doubt, ImpedanceControllerSpec


def doubt_values(name: str, achieved: tuple[Achieved, ...]) -> Iterator[Doubt]:
    """Yield what is beyond the usual limits, and no goal speaks of it: one line a controller.

    A goal for Ms or for the disk margin limits gain and phase together, so it speaks of both.
    """
    given = {item.measure for item in achieved if item.goal is not None}
    judged = given.union(MARGINS) if given & {SENSITIVITY_PEAK, DISK_MARGIN} else given
    bad, keys = [], []
    for item in achieved:
        measure, limit = item.measure, item.measure.doubtful
        known = not math.isnan(item.value)
        missed = known and limit is not None and measure.violation(item.value, limit) > 0
        if limit is None or measure in judged or not missed:
            continue
        bad.append(
            f"{measure.title} {measure.text(item.value)} (usual: {measure.goal_text(limit)})"
        )
        keys.append(measure.goal)
    if bad:
        text = f"{name}: {', '.join(bad)}; a goal says what is accepted: {', '.join(keys)}"
        yield Doubt(("controllers", name), text)


def doubt_bounds(
    name: str, controller: ImpedanceControllerSpec, optimum: ImpedanceOptimum
) -> Iterator[Doubt]:
    """Yield which gains the bounds have chosen, not the cost.

    Parameters
    ----------
    name : str
        Of the controller.
    controller : ImpedanceControllerSpec
        With the bounds.
    optimum : ImpedanceOptimum
        What was found within them.
    """
    for gain, bounds, value in (
        ("Mt", controller.Mt, optimum.Mt),
        ("Bt", controller.Bt, optimum.Bt),
    ):
        if bounds.fixed:
            continue
        for side, end in (("lower", bounds.min), ("upper", bounds.max)):
            if value == end.si:
                text = f"{name}: {gain} is on its {side} bound {end.text}"
                yield Doubt(("controllers", name, gain), text)
