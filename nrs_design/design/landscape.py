"""Around a chosen admittance: the cost over Mt and Bt, and what it gives up.

All of it is floating point, and no part of any proof. The cost is that of the thesis, on its loop
in contact with the nominal environment; stability and dead time are those of the loop that is
proved.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from nrs_design.design.goals import Requirement
from nrs_design.design.impedance_optimum import (
    ImpedanceProblem,
    impedance_cost,
    optimize_impedance,
)
from nrs_design.design.transfer import FloatArray, all_roots
from nrs_design.errors import DesignError

_POINTS = 100
# How far beyond the bounds the map looks, as a factor.
_BEYOND = 4.0
# Where a bound of Mt is zero, the map ends at this share of the other.
_LEAST = 1e-3


@dataclass(frozen=True, eq=False)
class CostMap:
    """The cost over both gains."""

    # Mt, Bt: virtual masses in kg m^2 and dampings in N m s/rad, ascending.
    Mt: FloatArray
    Bt: FloatArray
    cost: FloatArray  # Shape (b, m). NaN where the nominal loop is not stable.
    # Shape (b, m). Largest real part of the roots of the nominal loop that is proved, in 1/s: it is
    # zero on the border.
    abscissa: FloatArray


@dataclass(frozen=True, slots=True)
class Alternative:
    """Another admittance, and what it costs."""

    name: str  # What it is best for
    # Mt, Bt: in kg m^2 and N m s/rad.
    Mt: float
    Bt: float
    cost: float  # With the weights of the design
    displayed: float  # Mean distance of the displayed impedance from the desired one, in decades
    sensitivity: float  # Mean sensitivity


def map_cost(problem: ImpedanceProblem, requirement: Requirement, Mt: float, Bt: float) -> CostMap:
    """Evaluate the cost within the bounds, around them, and around a point."""
    masses, dampings = (
        np.geomspace(*_ends(bounds, value), _POINTS)
        for bounds, value in ((problem.mass_bounds, Mt), (problem.damping_bounds, Bt))
    )
    grid = np.meshgrid(masses, dampings)
    found = []
    for corner in requirement.nominal:
        closed = requirement.loops(corner, *(each.ravel() for each in grid)).closed
        found.append(np.nanmax(all_roots(closed).real, axis=-1))
    abscissa = np.max(found, axis=0).reshape(grid[0].shape)
    cost = np.where(abscissa < 0, impedance_cost(problem, *grid), np.nan)
    return CostMap(masses, dampings, cost, abscissa)


def _ends(bounds: tuple[float, float], value: float) -> tuple[float, float]:
    high = max(bounds[1], value) or 1.0
    low = min(bounds[0], value) or _LEAST * high
    return low / _BEYOND, high * _BEYOND


def alternatives(problem: ImpedanceProblem, Mt: float, Bt: float) -> Iterator[Alternative]:
    """Yield the shipped gains, and those best for either part of the cost.

    Goals are not looked at: they may be why a cheaper admittance was not chosen.
    """
    yield _priced(problem, "as shipped", Mt, Bt)
    tries = (
        ("best for the displayed impedance alone", _weighted(problem, 1.0, 0.0)),
        ("best for the sensitivity alone", _weighted(problem, 0.0, 1.0)),
    )
    for name, other in tries:
        try:
            best = optimize_impedance(other)
        except DesignError:
            continue  # No admittance within the bounds is stable.
        yield _priced(problem, name, best.Mt, best.Bt)


def _weighted(problem: ImpedanceProblem, displayed: float, robust: float) -> ImpedanceProblem:
    return replace(problem, weight_displayed=displayed, weight_sensitivity=robust)


def _priced(problem: ImpedanceProblem, name: str, Mt: float, Bt: float) -> Alternative:
    costs = (
        float(impedance_cost(p, Mt, Bt))
        for p in (problem, _weighted(problem, 1.0, 0.0), _weighted(problem, 0.0, 1.0))
    )
    return Alternative(name, Mt, Bt, *costs)
