"""A simulated scenario, and what is certified beside it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from nrs_design.pipeline.certified_runs import CertifiedBound, CertifiedRate
    from nrs_design.pipeline.scenarios import Simulated


def run_facts(
    one: Simulated, bounds: tuple[CertifiedBound, ...], rate: CertifiedRate | None
) -> dict[str, Any]:
    """Return the facts of a run, in SI."""
    run = one.run
    return {
        "scenario": run.scenario,
        "engine": run.engine,
        "seed": one.scenario.seed,
        "stopped": run.stopped,
        "steps": run.steps,
        "refused_samples": run.refused,
        "saturated_samples": run.saturated,
        "missed_samples": run.missed,
        "not_modelled": list(run.left_out),
        "metrics": dict(one.metrics),
        "limits": dict(one.scenario.limits),
        "switches": [{"time": time, "to": name} for time, name in run.switches],
        "contacts": [
            {"time": time, "environment": name, "made": made} for time, name, made in run.contacts
        ],
        "certified_bounds": [
            {
                "output": b.output,
                "unit": b.unit,
                "level": b.level,
                "holds_for_this_run": not b.uncovered,
                "uncovered": list(b.uncovered),
            }
            for b in bounds
        ],
        "certified_rate": None
        if rate is None
        else {
            "rate": rate.rate,
            "unit": rate.unit,
            "attained": rate.attained,
            "from": rate.start,
            "holds_for_this_run": not rate.uncovered,
            "uncovered": list(rate.uncovered),
        },
    }
