"""The best admittance that meets the goals of its controller, and the gains that ship then."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from itertools import product
from math import isclose

import numpy as np

from nrs_design.controllers.controller_design import ImpedanceOptimum
from nrs_design.design.goals import NOT_COMPUTED, Requirement
from nrs_design.design.impedance_optimum import (
    MISSED,
    ImpedanceProblem,
    impedance_cost,
    optimize_impedance,
)
from nrs_design.design.measures import CREEP_MEASURES, Measure
from nrs_design.errors import DesignError
from nrs_design.models.axis import unit

_BOUND_TOLERANCE = 1e-3  # Largest relative distance of a gain from its active bound


def optimize_with_goals(problem: ImpedanceProblem, requirement: Requirement) -> ImpedanceOptimum:
    """Find the global minimum of the cost over the admittances that meet all goals.

    Goals are held against the loop that is proved; the cost is that of the thesis. Where none is
    met within the bounds, the `DesignError` names the goal and the best value.
    """
    unknown = (m for m, _ in requirement.goals if m not in CREEP_MEASURES)
    if requirement.axis is None and (measure := next(unknown, None)) is not None:
        raise DesignError(
            f"the {measure.title} is {NOT_COMPUTED}",
            remedy=f"leave the goal {measure.goal} out, or outer_period",
            at=("goals", measure.goal),
        )
    optimum = optimize_impedance(problem)
    if meets(requirement, optimum.Mt, optimum.Bt):
        return optimum
    optimum = optimize_impedance(problem, requirement.violation)
    if optimum.cost >= MISSED:
        raise _unreachable(problem, requirement, optimum.Mt, optimum.Bt)
    return optimum


def meets(requirement: Requirement, Mt: float, Bt: float) -> bool:
    """Tell whether an admittance meets all goals."""
    return bool(requirement.violation(np.array([Mt]), np.array([Bt]))[0] <= 0)


def best_rounding(
    problem: ImpedanceProblem,
    requirement: Requirement,
    candidates: tuple[Iterable[float], Iterable[float]],
) -> tuple[float, float] | None:
    """Return the cheapest pair of rounded gains that meets all goals, or None."""
    pairs = [pair for pair in product(*candidates) if meets(requirement, *pair)]
    return min(pairs, key=lambda pair: float(impedance_cost(problem, *pair)), default=None)


def _unreachable(
    problem: ImpedanceProblem, requirement: Requirement, Mt: float, Bt: float
) -> DesignError:
    """Name a goal that no admittance meets, or those that none meets together."""
    (lowest_mass, highest_mass), (low, high) = problem.mass_bounds, problem.damping_bounds
    bounds = (
        f"Mt in [{lowest_mass:.6g}, {highest_mass:.6g}] {unit('kg m^2')} and "
        f"Bt in [{low:.6g}, {high:.6g}] {unit('N m s/rad')}"
    )
    for measure, goal in requirement.goals:
        single = replace(requirement, goals=((measure, goal),))
        best = optimize_impedance(problem, single.violation)
        if best.cost >= MISSED:
            return DesignError(
                f"the goal {measure.goal}, {measure.goal_text(goal)}, cannot be met with {bounds}: "
                f"the best is {_describe_value(single, measure, best.Mt, best.Bt)}",
                remedy=_remedy("this goal", problem, best.Mt, best.Bt),
            )
    values = requirement.goals
    missed = [
        f"{measure.title} {_describe_value(requirement, measure, Mt, Bt)}"
        for measure, goal in values
        if measure.violation(_value(requirement, measure, Mt, Bt)[0], goal) > 0
    ]
    goals = ", ".join(f"{measure.goal} {measure.goal_text(goal)}" for measure, goal in values)
    return DesignError(
        f"the goals cannot be met together ({goals}) with {bounds}: the nearest gains, "
        f"Mt = {Mt:.4g} {unit('kg m^2')} and Bt = {Bt:.4g} {unit('N m s/rad')}, have "
        f"{', '.join(missed)}",
        remedy=_remedy("one of these goals", problem, Mt, Bt),
    )


def _remedy(goals: str, problem: ImpedanceProblem, Mt: float, Bt: float) -> str:
    """Advise other goals, and other bounds where the best gains lie on a bound."""
    gains = {"Mt": (Mt, problem.mass_bounds), "Bt": (Bt, problem.damping_bounds)}
    bounds = [
        name
        for name, (value, ends) in gains.items()
        if any(isclose(value, end, rel_tol=_BOUND_TOLERANCE) for end in ends)
    ]
    widen = f", widen the bounds of {' and '.join(bounds)}" if bounds else ""
    return f"relax {goals}{widen}, or narrow the ranges of the contacts"


def _describe_value(requirement: Requirement, measure: Measure, Mt: float, Bt: float) -> str:
    value, place = _value(requirement, measure, Mt, Bt)
    return f"{measure.text(value)} ({place})"


def _value(requirement: Requirement, measure: Measure, Mt: float, Bt: float) -> tuple[float, str]:
    (value,), (where,) = requirement.values(measure, np.array([Mt]), np.array([Bt]))
    return float(value), where
