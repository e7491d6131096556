"""Around a chosen admittance: the cost over Mt and Bt, and what it gives up.

All of it is floating point, and no part of any proof. The cost is that of the thesis, on its loop
in contact with the nominal environment; stability and dead time are those of the loop that is
proved.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
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
    alone = {
        "displayed impedance": replace(problem, weight_displayed=1.0, weight_sensitivity=0.0),
        "sensitivity": replace(problem, weight_displayed=0.0, weight_sensitivity=1.0),
    }

    def priced(name: str, Mt: float, Bt: float) -> Alternative:
        costs = (float(impedance_cost(each, Mt, Bt)) for each in (problem, *alone.values()))
        return Alternative(name, Mt, Bt, *costs)

    yield priced("as shipped", Mt, Bt)
    for part, other in alone.items():
        with suppress(DesignError):  # No admittance within the bounds is stable.
            best = optimize_impedance(other)
            yield priced(f"best for the {part} alone", best.Mt, best.Bt)
