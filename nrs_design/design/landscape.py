"""What a chosen admittance gives up, by the cost of the thesis: floating point, and no proof."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, replace

from nrs_design.design.impedance_optimum import (
    ImpedanceProblem,
    impedance_cost,
    optimize_impedance,
)
from nrs_design.errors import DesignError


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
