"""What can be done with a spec file."""

import json

import pytest

import nrs_design as nrs
from nrs_design.errors import DesignError
from tests.api.pairs import pair
from tests.support import ROOT, SOFT_TISSUE


def test_unknown_method():
    with pytest.raises(DesignError, match="no method 'foo'"):
        nrs.certify(pair(6), method="foo")


def test_the_search_goes_as_far_as_the_spec_says(tmp_path):
    """Like `certify-switching`: a polynomial function of degree 4 would prove it."""
    path = nrs.certify(pair(6), name="pair").save(tmp_path).with_name("pair.nrs.yaml")
    document = json.loads(path.read_text())
    short = document | {"certification": {"budget": 1e-9}}
    path.write_text(json.dumps(short))
    study = nrs.load(path)
    assert repr(study) == "<Study of pair, switched-system>"
    assert study.certify().verdict == "inconclusive"
    assert study.certify(budget=60).verdict == "proved"


def test_options_of_runs_are_checked():
    study = nrs.load(SOFT_TISSUE)
    for options, said in (({"period": 0}, "the period"), ({"delay": -1}, "the delay")):
        with pytest.raises(DesignError, match=said):
            study.simulate(**options)
    with pytest.raises(DesignError, match="has no name"):
        study.simulate(["one", "two"])


def test_scenarios_are_simulated():
    study = nrs.load(ROOT / "docs/examples/scenarios.nrs.yaml")
    switched, not_switched = study.simulate("withdrawal-switched", "withdrawal-not-switched")
    (sooner,), (later,) = (one.metrics["withdrawal_times"] for one in (switched, not_switched))
    # Thesis 6.3.2.3 measures about 20 %, from torques that it does not print.
    assert 1 - sooner / later == pytest.approx(0.289, abs=0.002)
    (one,) = study.simulate("shaken", period=0.001)
    assert one.run.sampling == (0.001, 0, 0)
    with pytest.raises(DesignError, match="no engine"):
        study.simulate(engine="fast")
    with pytest.raises(DesignError, match="describes no interaction"):
        nrs.load(ROOT / "specs/examples/commuting.nrs.yaml").simulate()
