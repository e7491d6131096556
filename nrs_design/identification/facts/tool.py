"""A tool on a force sensor."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from nrs_design.identification.facts.finding import Facts, estimate_numbers

if TYPE_CHECKING:
    from nrs_design.identification.statistics import Estimate
    from nrs_design.identification.tool import ToolIdentification


def tool_facts(found: ToolIdentification) -> Facts:
    """Return mass, center of mass and bias."""

    def along(values: Sequence[Estimate]) -> Facts:
        return {axis: estimate_numbers(e) for axis, e in zip("xyz", values, strict=True)}

    return {
        "poses": len(found.force_errors),
        "gravity_m_s2": found.gravity,
        "mass_kg": estimate_numbers(found.mass),
        "center_of_mass_m": along(found.center),
        "force_bias_N": along(found.force_bias),
        "torque_bias_Nm": along(found.torque_bias),
        "rmse": {"force_N": found.rmse[0], "torque_Nm": found.rmse[1]},
    }
