"""Reasons to doubt a design that its spec does not exclude by a goal, and what would hold."""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Iterator
from itertools import combinations
from math import floor, log10

from nrs_design.controllers.controller_design import ControllerDesign, ImpedanceOptimum
from nrs_design.design.goals import Achieved, Requirement
from nrs_design.design.measures import (
    DISK_MARGIN,
    IMPEDANCE_ERROR,
    MARGINS,
    SENSITIVITY_PEAK,
    Measure,
)
from nrs_design.models.axis import unit
from nrs_design.models.contact.environment import Environment
from nrs_design.spec import Doubt, ImpedanceControllerSpec, InteractionDesignSpec

_DECADES = 4  # How far to look for a damping


def doubt_values(name: str, achieved: tuple[Achieved, ...], *, provable: bool) -> Iterator[Doubt]:
    """Yield one doubt about all unusual values of a controller that no goal limits.

    A goal for Ms or for the disk margin limits gain and phase together, so it speaks of both. It is
    advised only where it can be met: of values that are `provable`, or the worst of all ranges.
    """
    found = [item for item in achieved if is_unusual(item.measure, achieved)]
    if not found:
        return
    excess = max(map(_excess, found))
    peak = next((item for item in found if item.measure is SENSITIVITY_PEAK), None)
    if peak is not None and math.isinf(peak.value):
        text = f"{name}: the loop is unstable at {peak.where}"
        yield Doubt(("controllers", name), text, beyond=excess)
        return
    bad = (
        f"{item.measure.title} {item.measure.text(item.value)} (usual: {item.measure.usual})"
        for item in found
    )
    keys = [item.measure.goal for item in found if provable or item.everywhere]
    advice = f"; a goal says what is accepted: {', '.join(keys)}" if keys else ""
    yield Doubt(("controllers", name), f"{name}: {', '.join(bad)}{advice}", beyond=excess)


def is_unusual(measure: Measure, achieved: tuple[Achieved, ...]) -> bool:
    """Tell whether a measure is beyond its usual limit, and no goal speaks of it."""
    given = {item.measure for item in achieved if item.goal is not None}
    measures = given.union(MARGINS) if given & {SENSITIVITY_PEAK, DISK_MARGIN} else given
    limit = measure.doubtful
    if limit is None or measure in measures:
        return False
    values = (item.value for item in achieved if item.measure == measure)
    if measure is IMPEDANCE_ERROR:
        # A spring displays an infinite impedance at rest, as is its purpose.
        return any(math.isfinite(v) and measure.violation(v, limit) > 0 for v in values)
    return any(not math.isnan(v) and measure.violation(v, limit) > 0 for v in values)


def _excess(item: Achieved) -> float:
    """Return a value over the usual limit of its measure, or the limit over the value."""
    assert item.measure.doubtful is not None, "it is unusual"
    return 1 + item.measure.violation(item.value, item.measure.doubtful)


def doubt_same(spec: InteractionDesignSpec, design: ControllerDesign) -> Iterator[Doubt]:
    """Yield the controllers that are another one by another name: a switch to them does nothing."""

    def acts(name: str) -> object:
        return getattr(spec.controllers[name], "offset", None)

    for one, other in combinations(design.controllers, 2):
        if (one.law, one.contacts, acts(one.name)) == (other.law, other.contacts, acts(other.name)):
            text = f"{other.name}: the same law, gains and contacts as {one.name}"
            yield Doubt(("controllers", other.name), text, beyond=1.0)


def doubt_bounds(
    name: str, controller: ImpedanceControllerSpec, optimum: ImpedanceOptimum
) -> Iterator[Doubt]:
    """Yield which gains the bounds have chosen, not the cost."""
    for gain, bounds, value in (
        ("Mt", controller.Mt, optimum.Mt),
        ("Bt", controller.Bt, optimum.Bt),
    ):
        if bounds.fixed:
            continue
        for side, end in (("lower", bounds.min), ("upper", bounds.max)):
            if value == end.si:
                text = f"{name}: {gain} is on its {side} bound {end.text}"
                yield Doubt(("controllers", name, gain), text, beyond=1.0)


def doubt_stiffness(
    name: str, requirement: Requirement, contacts: tuple[Environment, ...], Mt: float, Bt: float
) -> Iterator[Doubt]:
    """Yield the contacts whose stiffness reaches the limit of an admittance."""
    limits = requirement.stiffness_limits(Mt, Bt)
    for contact in contacts:
        highest, (limit, _) = float(contact.stiffness.high), limits[contact.name]
        if highest < limit or math.isnan(limit):
            continue
        enough = enough_damping(requirement, contact.name, Mt, Bt, highest)
        remark = "no Bt would hold it"
        if enough is not None:
            remark = f"Bt = {enough:g} {unit('N*m*s/rad')} would just hold it, while constant"
        text = (
            f"{name}: {contact.name} is up to {highest:.6g} {unit('N*m/rad')} stiff, and its gains "
            f"hold less than {limit:.6g}; {remark} (floating point, not a proof)"
        )
        yield Doubt(("controllers", name), text)


def enough_damping(
    requirement: Requirement, environment: str, Mt: float, Bt: float, stiffness: float
) -> float | None:
    """Return the least damping above Bt, of three digits, that is stable up to a stiffness.

    The stiffness is in N m/rad. None if none up to 10,000 times Bt is enough.
    """

    def holds(damping: float) -> bool:
        limits = requirement.stiffness_limits(Mt, damping)
        return limits[environment][0] > stiffness

    decades = range(floor(log10(Bt)), floor(log10(Bt)) + _DECADES + 1)
    candidates = [float(f"{n}e{decade - 2}") for decade in decades for n in range(100, 1000)]
    higher = [damping for damping in candidates if Bt < damping <= 10**_DECADES * Bt]
    first = bisect_left(higher, True, key=holds)
    return higher[first] if first < len(higher) else None
