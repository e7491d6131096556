"""How far gains are above the least cost: the thesis, by differential evolution, and bad ends."""

from fractions import Fraction

import numpy as np
import pytest
from scipy.optimize import differential_evolution

from nrs_design.design.cost_bound import NEARLY, bound_cost, why_no_bound
from nrs_design.design.impedance import ImpedanceLoop
from nrs_design.design.impedance_optimum import ImpedanceProblem, impedance_cost, optimize_impedance
from nrs_design.models.contact import Elastic
from nrs_design.thesis import thesis

DESIRED = thesis.TORQUE / thesis.VELOCITY


def problem(desired=DESIRED, mass=(0.01, 1.0), damping=(0.1, 20.0), Kt=0.0, lags=(1.0,)):
    loop = ImpedanceLoop(thesis.EXACT_LOOP, Elastic(thesis.SOFT), Kt, lags)
    return ImpedanceProblem(loop, desired, 4 * np.pi, mass, damping)


@pytest.mark.parametrize(("desired", "Bt"), [(DESIRED, 2.15), (DESIRED / 2, 1.04)])
def test_the_gains_of_the_thesis_are_the_global_optimum(desired, Bt):
    """Thesis 6.3.2.1, rounded to three digits: a few millionths above it, in some hundred boxes."""
    given = problem(desired)
    found = bound_cost(given, 0.01, Bt)
    cost = impedance_cost(given, 0.01, Bt)
    assert float(found.above) == pytest.approx(float(cost), rel=1e-12)
    assert found.reached
    assert 0 < found.gap < Fraction(1, 10**5)
    assert 100 < found.boxes < 525
    assert found.text.startswith("global optimum within 0.0000")


def test_differential_evolution_does_not_beat_the_bound():
    given = problem(damping=(0.5, 5.0), mass=(0.005, 0.2))
    optimum = optimize_impedance(given)
    found = bound_cost(given, optimum.Mt, optimum.Bt)
    best = differential_evolution(
        lambda x: float(impedance_cost(given, *x)),
        (given.mass_bounds, given.damping_bounds),
        rng=1,
        maxiter=20,
        popsize=8,
    )
    assert found.reached
    assert found.below <= Fraction(best.fun)
    assert found.gap <= NEARLY + Fraction(1, 10**12)


def test_a_spring_and_a_filter_are_in_the_cost():
    given = problem(Kt=2.0, lags=(0.02, 1.0), mass=(0.05, 0.05), damping=(1.0, 4.0))
    grid = impedance_cost(given, 0.05, np.linspace(1, 4, 3001))
    found = bound_cost(given, 0.05, 2.0)
    assert found.reached
    assert Fraction(grid.min()) - 2 * NEARLY < found.below <= Fraction(grid.min())


def test_a_search_that_is_cut_off_says_so():
    found = bound_cost(problem(), 0.01, 2.15, most=20)
    assert not found.reached
    assert found.gap > NEARLY
    assert found.text.endswith("boxes, where the search ended")


def test_beside_goals_it_is_another_optimum():
    found = bound_cost(problem(mass=(0.01, 0.01)), 0.01, 3.0, goals=True)
    assert found.text.startswith("least cost without goals within")
    assert found.gap > Fraction(1, 100)


def test_what_is_not_covered():
    assert why_no_bound(problem()) == ""
    assert why_no_bound(problem(mass=(0.1, 0.1), damping=(2.0, 2.0))) == "Mt and Bt are given"
