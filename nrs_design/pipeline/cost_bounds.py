"""How near the gains of every controller are to the least cost."""

from __future__ import annotations

from dataclasses import replace

from nrs_design.design.analysis import DesignAnalysis
from nrs_design.design.cost_bound import CostBound, bound_cost, why_no_bound


def run_cost_bounds(chosen: DesignAnalysis, shipped: DesignAnalysis) -> dict[str, CostBound | str]:
    """Bound the least cost of each impedance controller, or say why it is not bounded.

    The bound is about the loop of what ships, which `design.free` may have changed.
    """
    found: dict[str, CostBound | str] = {}
    for item, own in zip(chosen.impedance, shipped.impedance, strict=True):
        goals = bool(item.requirement.goals) or shipped is not chosen
        problem = replace(
            own.problem,
            mass_bounds=item.problem.mass_bounds,
            damping_bounds=item.problem.damping_bounds,
        )
        why_not = why_no_bound(problem)
        found[item.name] = why_not or bound_cost(problem, own.Mt, own.Bt, goals=goals)
    return found
