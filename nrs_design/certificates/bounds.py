"""The numbers of the bounds that a certificate states, rounded to their safe side."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from nrs_design.proof.bounds import lower_float, upper_float
from nrs_design.proof.evidence import AbstractEvidence
from nrs_design.proof.evidence.abstract import Bound
from nrs_design.proof.system import SwitchedSystem


def bounds_summary(
    system: SwitchedSystem, statements: Iterable[AbstractEvidence]
) -> list[dict[str, Any]]:
    """Return every bound with what it holds under, for programs; statements have been checked."""
    return [
        {
            "output": bound.output.name,
            "unit": bound.output.unit,
            # Not below what is proved, and disturbances not above.
            "level": upper_float(bound.level),
            "limit": None if bound.output.limit is None else lower_float(bound.output.limit),
            "under": [
                {"name": c.name, "unit": c.unit, "bound": lower_float(c.bound)}
                for c in bound.channels
            ],
            "rounding_included": item.covers_rounding,
        }
        for item in statements
        if (bound := item.bound(system)) is not None
    ]


def bound_on(
    system: SwitchedSystem, statements: Iterable[AbstractEvidence], output: str
) -> Bound | None:
    """Return the bound on an output under all disturbances of a system at once, if it is stated.

    The statements have been checked.
    """
    bounds = (item.bound(system) for item in statements)
    every = set(system.channels)
    found = (b for b in bounds if b is not None and b.output.name == output)
    return next((b for b in found if set(b.channels) == every), None)


def keeps_command(system: SwitchedSystem, statements: Iterable[AbstractEvidence]) -> bool:
    """Tell whether a bound shows that the motor's driver does not saturate from rest.

    The statements have been checked; bounds that leave out what is rounded do not count.
    """
    from nrs_design.spec.motion import MOTOR_COMMAND

    bounds = (item.bound(system) for item in statements if item.covers_rounding)
    return any(
        bound.output.limit is not None and bound.level <= bound.output.limit
        for bound in bounds
        if bound is not None and bound.output.name.startswith(MOTOR_COMMAND)
    )
