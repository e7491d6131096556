"""What a design gives up, on the published loop of the thesis (6.3.2)."""

from dataclasses import replace

import pytest

from nrs_design.design.landscape import alternatives
from nrs_design.pipeline.design import run_analysis
from nrs_design.pipeline.runs import run_design
from nrs_design.spec import read_spec
from tests.support import SOFT_TISSUE


@pytest.fixture(scope="module")
def insertion():
    return run_analysis(run_design(read_spec(SOFT_TISSUE))).impedance[0]


def test_each_alternative_is_the_best_at_what_it_is_named_for(insertion):
    shipped, displayed, robust = alternatives(insertion.problem, insertion.Mt, insertion.Bt)
    assert (shipped.Mt, shipped.Bt) == (insertion.Mt, insertion.Bt)
    assert shipped.cost == pytest.approx(insertion.cost)
    assert shipped.cost == pytest.approx((shipped.displayed + shipped.sensitivity) / 2)
    assert displayed.displayed < shipped.displayed
    assert displayed.sensitivity > shipped.sensitivity
    assert robust.sensitivity < shipped.sensitivity
    assert robust.displayed > shipped.displayed


def test_fixed_gains_have_no_alternative(insertion):
    fixed = replace(insertion.problem, mass_bounds=(0.01, 0.01), damping_bounds=(2.15, 2.15))
    assert [other.Bt for other in alternatives(fixed, 0.01, 2.15)] == [2.15] * 3
