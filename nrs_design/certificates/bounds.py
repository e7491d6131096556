"""The numbers of the bounds that a certificate states, rounded to their safe side."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from nrs_design.proof.bounds import lower_float, upper_float
from nrs_design.proof.evidence import AbstractEvidence, InvariantEllipsoid
from nrs_design.proof.system import SwitchedSystem


def bounds_summary(
    system: SwitchedSystem, statements: Iterable[AbstractEvidence]
) -> list[dict[str, Any]]:
    """Return every bound with what it holds under, for programs.

    Parameters
    ----------
    system : SwitchedSystem
        What the statements are about.
    statements : iterable of AbstractEvidence
        Checked; those that are no bounds are passed over.
    """
    outputs = {output.name: output for output in system.outputs}
    return [
        {
            "output": item.output,
            "unit": outputs[item.output].unit,
            # Not below what is proved, and disturbances not above.
            "level": upper_float(item.level),
            "limit": None if (limit := outputs[item.output].limit) is None else float(limit),
            "under": [
                {"name": c.name, "unit": c.unit, "bound": lower_float(c.bound)}
                for c in item.acting(system)
            ],
            "rounding_included": item.covers_rounding,
        }
        for item in statements
        if isinstance(item, InvariantEllipsoid)
    ]


def bound_on(
    system: SwitchedSystem, statements: Iterable[AbstractEvidence], output: str
) -> InvariantEllipsoid | None:
    """Return the bound on an output under all disturbances of a system at once, if it is stated.

    Parameters
    ----------
    system : SwitchedSystem
        What the statements are about.
    statements : iterable of AbstractEvidence
        Checked.
    output : str
        Its name.
    """
    every = {channel.name for channel in system.channels}
    return next(
        (
            item
            for item in statements
            if isinstance(item, InvariantEllipsoid)
            and item.output == output
            and set(item.channels) == every
        ),
        None,
    )
