"""What `tune` and the report say of controllers that make torques."""

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.design.laws.torque_impedance import passivity_margin
from nrs_design.pipeline.design import run_analysis
from nrs_design.pipeline.runs import run_design
from nrs_design.spec import read_spec
from nrs_design.spec.templates import TEMPLATES
from tests.literature.test_colgate_schenkel import is_passive
from tests.support import document_of, replaced, run, spec_in

TEXT = TEMPLATES["torque-interface"]
AT_ONCE = ((", latency: 0.3 ms", ""), ("  dead_time: 0.2 ms", "  #"))
SHAPED = ("    # inertia", "    inertia")
RANGED = "friction: {nominal: 1 N*m*s/rad, range: [0.4 N*m*s/rad, 2 N*m*s/rad]}"


@pytest.fixture
def analyzed(tmp_path):
    def make(*edits):
        path = spec_in(tmp_path, replaced(TEXT, *edits), "mine")
        return run_analysis(run_design(read_spec(path))).torque

    return make


def test_passivity_is_decided_where_the_condition_holds(analyzed):
    """With the least friction of the range: b = 0.4, K T/2 + B."""
    lighter = ("damping: 3 N*m*s/rad", "damping: 0.25 N*m*s/rad")
    soft, firm = analyzed(*AT_ONCE, ("friction: 0.5 N*m*s/rad", RANGED), lighter)
    assert float(soft.margin) == pytest.approx(0.4 - 30 * 0.0005 - 0.25, abs=1e-6)
    assert soft.passive_text.startswith("yes, 0.13")
    assert float(firm.margin) == pytest.approx(0.4 - 60 * 0.0005 - 5, abs=1e-6)
    assert firm.passive_text == "no, -4.63"


@pytest.mark.parametrize("edits", [AT_ONCE[:1], AT_ONCE[1:], (*AT_ONCE, SHAPED)])
def test_it_is_not_decided_otherwise(analyzed, edits):
    assert analyzed(*edits)[0].passive_text == "not decided"


def test_tune_prints_it(tmp_path):
    path = spec_in(tmp_path, TEXT, "mine")
    said = run("tune", path, cwd=tmp_path, code=0).stdout
    assert "Colgate and Schenkel" in said
    items = document_of("tune", path, cwd=tmp_path)["torque"]
    assert [item["passivity_margin"] for item in items] == [None, None]


F = Fraction


@given(st.integers(0, 2000), st.integers(-8, 8), st.sampled_from([F(1, 1000), F(1, 200)]))
def test_passivity_is_the_condition_at_all_frequencies(K, B, T):
    """Colgate and Schenkel 1997, equation 13, decided by the first root of a polynomial."""
    limit = F(K) * T / 2 + abs(F(B))
    for b in (limit * F(9, 10), limit * F(11, 10)):
        if K and b != limit:
            assert (passivity_margin(b, F(K), F(B), T) > 0) == is_passive(b, F(K), F(B), T)
