"""What would hold where a contact is too stiff for an admittance: more virtual damping."""

from __future__ import annotations

import math
from collections.abc import Iterator

from nrs_design.axis import unit
from nrs_design.controllers.float32 import round_significant
from nrs_design.design.goals import Requirement
from nrs_design.models.contact.environment import Environment
from nrs_design.spec import Doubt

# How far to look for a damping, as a factor, and how near to the least one to come.
_FURTHEST, _NEAR = 1e4, 1e-3
_DIGITS = 3


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
        held = "no Bt would hold it"
        if enough is not None:
            held = f"Bt = {enough:g} {unit('N*m*s/rad')} would just hold it, while constant"
        text = (
            f"{name}: {contact.name} is up to {highest:.6g} {unit('N*m/rad')} stiff, and its gains "
            f"hold less than {limit:.6g}; {held} (floating point, not a proof)"
        )
        yield Doubt(("controllers", name), text)


def enough_damping(
    requirement: Requirement, environment: str, Mt: float, Bt: float, stiffness: float
) -> float | None:
    """Return a damping above Bt, of few digits, that is stable up to a stiffness in N m/rad.

    The least one, rounded up; None if none up to 10,000 times Bt is enough.
    """

    def holds(damping: float) -> bool:
        limits = requirement.stiffness_limits(Mt, damping)
        return limits[environment][0] > stiffness

    low, high = Bt, Bt
    while not holds(high):
        low, high = high, 2 * high
        if high > _FURTHEST * Bt:
            return None
    while high - low > _NEAR * high:
        middle = (low + high) / 2
        low, high = (low, middle) if holds(middle) else (middle, high)
    return next(
        float(rounded)
        for up in range(100)
        if (rounded := round_significant(high * (1 + up * _NEAR), _DIGITS)) >= high
    )
