"""The cost around a design, on the published loop of the thesis (6.3.2)."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.contour import QuadContourSet

from nrs_design.design.impedance_optimum import impedance_cost, stabilizes
from nrs_design.design.landscape import alternatives, map_cost
from nrs_design.pipeline.design import run_analysis
from nrs_design.pipeline.runs import run_design
from nrs_design.reporting.sections.landscape import draw_cost
from nrs_design.spec import read_spec
from tests.support import SOFT_TISSUE


@pytest.fixture(scope="module")
def insertion():
    return run_analysis(run_design(read_spec(SOFT_TISSUE))).impedance[0]


def test_no_point_within_the_bounds_costs_less_than_the_optimum(insertion):
    found = map_cost(insertion.problem, insertion.requirement, insertion.Mt, insertion.Bt)
    (left, right), (low, high) = insertion.problem.mass_bounds, insertion.problem.damping_bounds
    columns = (left <= found.Mt) & (found.Mt <= right)
    rows = (low <= found.Bt) & (found.Bt <= high)
    assert found.Mt[0] < left < right < found.Mt[-1]
    inside = found.cost[np.ix_(rows, columns)]
    assert np.nanmin(inside) >= insertion.optimum.cost
    assert np.nanmin(inside) == pytest.approx(insertion.optimum.cost, rel=0.05)


def test_the_border_is_that_of_stability(insertion):
    found = map_cost(insertion.problem, insertion.requirement, insertion.Mt, insertion.Bt)
    Mt, Bt = np.meshgrid(found.Mt, found.Bt)
    assert (np.isfinite(found.cost) == stabilizes(insertion.problem.loop, Mt, Bt)).all()
    assert np.isnan(found.cost).any()


def test_the_drawn_border_is_where_a_pole_is_on_the_axis(insertion):
    """D-decomposition: Mt s + Bt = -N(s) / D(s) has one admittance for each s = j w."""
    found = map_cost(insertion.problem, insertion.requirement, insertion.Mt, insertion.Bt)
    numerator, denominator = insertion.problem.loop.forward
    s = 1j * np.geomspace(0.1, 1e3, 20000)
    exact = -np.polyval(numerator, s) / np.polyval(denominator, s)
    Bt, Mt = exact.real, (exact / s).real
    inside = (found.Mt[0] < Mt) & (Mt < found.Mt[-1]) & (found.Bt[0] < Bt) & (Bt < found.Bt[-1])
    curve = np.log(np.column_stack([Mt[inside], Bt[inside]]))
    figure = draw_cost(insertion, found)
    (border,) = (
        item
        for item in figure.axes[0].collections
        if isinstance(item, QuadContourSet) and item.get_linewidth()[0] == 2.0
    )
    drawn = np.log(np.concatenate([path.vertices for path in border.get_paths()]))
    assert len(drawn) > 20
    apart = np.linalg.norm(drawn[:, None] - curve[None], axis=2).min(axis=1)
    step = np.log(found.Mt[1] / found.Mt[0])
    # Steps of the grid were up to half of it away; so near, no eye sees a difference.
    assert apart.max() < 0.05 * step


def test_each_alternative_is_the_best_at_what_it_is_named_for(insertion):
    shipped, displayed, robust = alternatives(insertion.problem, insertion.Mt, insertion.Bt)
    assert (shipped.Mt, shipped.Bt) == (insertion.Mt, insertion.Bt)
    assert shipped.cost == pytest.approx(insertion.cost)
    assert shipped.cost == pytest.approx((shipped.displayed + shipped.sensitivity) / 2)
    assert displayed.displayed < shipped.displayed
    assert displayed.sensitivity > shipped.sensitivity
    assert robust.sensitivity < shipped.sensitivity
    assert robust.displayed > shipped.displayed


def test_fixed_gains_have_a_map(insertion):
    fixed = replace(insertion.problem, mass_bounds=(0.01, 0.01), damping_bounds=(2.15, 2.15))
    found = map_cost(fixed, insertion.requirement, 0.01, 2.15)
    assert found.Mt[0] < 0.01 < found.Mt[-1]
    assert [other.Bt for other in alternatives(fixed, 0.01, 2.15)] == [2.15] * 3


def test_a_mass_of_zero_has_a_map(insertion):
    bounds = replace(insertion.problem, mass_bounds=(0.0, 1.0))
    found = map_cost(bounds, insertion.requirement, 0.0, 2.15)
    assert 0 < found.Mt[0] < 1e-3
    assert found.cost[50, 0] == pytest.approx(
        float(impedance_cost(bounds, found.Mt[0], found.Bt[50]))
    )
