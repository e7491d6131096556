"""Virtual mass and damping of the four designs of thesis 6.3 and 6.4."""

from __future__ import annotations

from math import pi, radians

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import Bounds, differential_evolution

from benchmarks.measure import Comparison, Size, time_side_by_side
from nrs_design.design.impedance_optimum import (
    ImpedanceLoop,
    ImpedanceProblem,
    impedance_cost,
    optimize_impedance,
    stabilizes,
)
from nrs_design.design.transfer import TransferFunction
from nrs_design.models.contact import Elastic

MOTION = TransferFunction((0.99, 56.82), (0.0351, 1.99, 56.82))
DESIRED = 0.3 / radians(8)
DESIGNS = (
    (43.0356, DESIRED, 0.0),
    (43.0356, DESIRED, 0.01),
    (43.0356, DESIRED / 2, 0.01),
    (61.6608, DESIRED, 0.01),
)
TARGET = 20.0
UNSTABLE = 1e3


def run(size: Size) -> tuple[Comparison, ...]:
    """Measure all four designs together."""
    problems = [_problem(*design) for design in DESIGNS]
    (theirs, ours), (evolved, found) = time_side_by_side(
        size.pick(21, 3, 1),
        lambda: [_evolve(problem) for problem in problems],
        lambda: [optimize_impedance(problem).cost for problem in problems],
    )
    assert isinstance(evolved, list)
    assert isinstance(found, list)
    excess = max(theirs - ours for theirs, ours in zip(evolved, found, strict=True))
    note = f"cost of the peer less ours: at most {excess:+.1e}, for costs from {min(found):.3f}"
    return (
        Comparison("Mt/Bt, four designs", "differential_evolution", theirs, ours, TARGET, note),
    )


def _problem(stiffness: float, desired: float, least: float) -> ImpedanceProblem:
    return ImpedanceProblem(
        loop=ImpedanceLoop(MOTION, Elastic(stiffness)),
        desired=desired,
        bandwidth=4 * pi,
        mass_bounds=(least, 1.0),
        damping_bounds=(0.1, 20.0),
    )


def _evolve(problem: ImpedanceProblem) -> float:
    def cost(x: NDArray[np.float64], /) -> float:
        Mt, Bt = x
        stable = bool(stabilizes(problem.loop, Mt, Bt))
        return float(impedance_cost(problem, Mt, Bt)) if stable else UNSTABLE

    low, high = np.array([problem.mass_bounds, problem.damping_bounds]).T
    return float(differential_evolution(cost, Bounds(low, high), rng=1).fun)
