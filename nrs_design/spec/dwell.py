"""What no dwell time can hold still: whoever claims a dwell time must ask here first.

A proof with a dwell time rests on one constant matrix from each switch to the next.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from nrs_design.spec.parameters import ParameterSpec


@dataclass(frozen=True, slots=True)
class DwellObstacle:
    """Why a spec and a dwell time exclude each other, and what to change in the spec."""

    message: str
    remedy: str


def find_changing_parameter(parameters: Mapping[str, ParameterSpec]) -> DwellObstacle | None:
    """Find a parameter of given matrices that is not known."""
    for name, parameter in parameters.items():
        if not parameter.fixed:
            return DwellObstacle(
                f"a dwell time and the range of parameter {name!r} exclude each other: the proof "
                "with a dwell time holds for constant matrices only",
                "give the parameter its nominal value only",
            )
    return None
