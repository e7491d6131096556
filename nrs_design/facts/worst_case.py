"""What an adversary found, beside limits and certified bounds."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from nrs_design.pipeline.worst_case import WorstCase


def worst_case_facts(case: WorstCase) -> dict[str, Any]:
    """Return what the adversary found, in SI."""
    from nrs_design.reporting.worst_case import LEFT_OUT, found_in

    found = [
        {
            "output": item.name,
            "unit": item.unit,
            "worst_found": item.value,
            "limit": item.limit,
            "certified_bound": item.bound,
            "bound_over_found": item.ratio,
            "exceeds_limit": item.exceeds,
            "duration": float(run.time[-1]),
        }
        for item, run in zip(found_in(case), case.runs, strict=True)
    ]
    return {
        "worst_case": {
            "disturbances": [
                {"name": c.name, "unit": c.unit, "bound": float(c.bound)}
                for c in case.system.channels
            ],
            "disturbances_declared": case.declared,
            "found": found,
            "not_modelled": [LEFT_OUT],
        },
    }
