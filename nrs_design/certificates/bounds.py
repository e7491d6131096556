"""The numbers of the bounds that a certificate states, rounded to their safe side."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from nrs_design.proof.bounds import lower_float, upper_float
from nrs_design.proof.evidence import AbstractEvidence
from nrs_design.proof.evidence.abstract import Bound
from nrs_design.proof.system import SwitchedSystem


def bounds_summary(
    system: SwitchedSystem, statements: Iterable[AbstractEvidence]
) -> list[dict[str, Any]]:
    """Return every bound with its conditions, for programs; statements have been checked."""
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
        for item, bound in _bounds(system, statements)
    ]


def bound_on(
    system: SwitchedSystem, statements: Iterable[AbstractEvidence], output: str
) -> Bound | None:
    """Return the bound on an output under all disturbances of a system at once, if it is stated.

    The statements have been checked.
    """
    bounds = (bound for _, bound in _bounds(system, statements) if bound.output.name == output)
    return next((one for one in bounds if {*one.channels} == {*system.channels}), None)


def keeps_command(system: SwitchedSystem, statements: Iterable[AbstractEvidence]) -> bool:
    """Tell whether a bound shows that the motor's driver does not saturate from rest.

    The statements have been checked; bounds without rounding errors do not count.
    """
    from nrs_design.spec.motion import MOTOR_COMMAND

    return any(
        bound.output.limit is not None and bound.level <= bound.output.limit
        for item, bound in _bounds(system, statements)
        if item.covers_rounding and bound.output.name.startswith(MOTOR_COMMAND)
    )


def _bounds(
    system: SwitchedSystem, statements: Iterable[AbstractEvidence]
) -> Iterator[tuple[AbstractEvidence, Bound]]:
    """Yield the statements of a bound, each with its bound."""
    for item in statements:
        if (bound := item.bound(system)) is not None:
            yield item, bound
