"""Runs: named signals with units, by place and by name."""

import numpy as np
import pytest

import nrs_design as nrs
from nrs_design.errors import CertificateError, DesignError
from tests.support import ROOT, SOFT_TISSUE

SCENARIOS = ROOT / "docs/examples/scenarios.nrs.yaml"


@pytest.fixture(scope="module")
def found():
    return nrs.load(SCENARIOS).simulate("shaken", "withdrawal-switched")


def test_signals_have_names_and_units(found):
    run = found["shaken"]
    assert run is found[0]
    assert run.time.shape == run["torque"].shape == run["hand"].shape == (len(run.active),)
    assert (run.units["torque"], run.units["velocity"], run.units["depth"]) == (
        "N*m",
        "rad/s",
        "rad",
    )
    assert np.abs(run["torque"]).max() == pytest.approx(run.metrics["peak_torque"])
    assert {signal.name for signal in run.signals} == set(run.units)
    with pytest.raises(DesignError, match="no signal 'force'") as caught:
        run["force"]
    assert "torque" in str(caught.value.remedy)


def test_runs_are_found_by_place_and_by_name(found):
    assert [run.name for run in found] == ["shaken", "withdrawal-switched"]
    assert found[-1].name == "withdrawal-switched"
    assert found[:1] == (found["shaken"],)
    assert len(found) == 2
    with pytest.raises(DesignError, match="no run of 'x'"):
        found["x"]


def test_it_is_told_in_a_line_and_proves_nothing(found):
    assert repr(found) == "<Simulation scenarios: 2 runs, which prove nothing>"
    assert len(repr(found["shaken"])) < 80
    assert "<td>shaken</td>" in found._repr_html_()


def test_a_run_is_drawn_by_the_name_of_its_scenario(found):
    assert found.figures == ("shaken", "withdrawal-switched")
    assert found.plot("shaken", width="ieee").get_size_inches()[0] == 3.5
    assert found["shaken"].plot().get_size_inches()[0] > 5


def test_certified_bounds_stand_beside_a_run(tmp_path, found):
    study = nrs.load(ROOT / "docs/examples/insertion-axis.nrs.yaml")
    assert not any(run.bounds for run in study.simulate())
    cert = study.certify().save(tmp_path)
    (run, *_) = study.simulate(certificate=cert)
    assert run.to_dict()["certified_rate"] is not None
    with pytest.raises(CertificateError):
        nrs.load(SOFT_TISSUE).simulate(certificate=cert)
