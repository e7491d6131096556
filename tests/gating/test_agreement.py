"""Every command says the same about the goals of a proof, of the same gains.

`optimize` and `gate` choose gains each for itself; `certify-switching`, `simulate` and `export`
take the way of `gate`; `report` and `export` with a certificate, that of `run_recorded`.
"""

import json

import pytest

from nrs_design.certificates.certificate import content_id, dump
from nrs_design.certificates.goals import certified_goals
from nrs_design.certificates.prove import read_document
from nrs_design.certificates.verify import verify_document
from nrs_design.controllers.gains import STEERING, steering_goals
from nrs_design.errors import DesignError
from nrs_design.pipeline.certified_optimum import run_certified_optimum
from nrs_design.pipeline.design import design_at_least_cost, run_analysis
from nrs_design.pipeline.runs import run_certification, run_recorded
from nrs_design.spec import read_spec
from tests.support import spec_in
from tests.tables import entry, spec_text

from .conftest import gate_of

pytestmark = pytest.mark.slow
# The loop of soft-tissue-sampled, for which gains of the least cost decay at 0.977 1/s.
BY_RATE = spec_text("by-rate")
CASE = entry(__file__, "CASE")


def written(folder, **changes):
    text = BY_RATE
    for key, value in (CASE | changes).items():
        text = text.replace(key, value)
    return spec_in(folder, text, "by-rate")


def goals_of(result):
    return goals_of_certificate(result.loaded, result.certificate)


def goals_of_certificate(loaded, certificate):
    found = certified_goals(loaded.spec, certificate)
    return {goal.key: (goal.said, goal.met) for goal in found}


def agreed(path, folder):
    """Return which goals are met, after every command has said the same."""
    loaded = read_spec(path)
    assert steering_goals(loaded.spec)
    designed = design_at_least_cost(loaded)
    (gate,) = gate_of(folder, path).specs
    recorded = run_recorded(loaded, gate.certificate)
    shown = goals_of(recorded)
    obligations = {
        item.subject.removeprefix("system: "): (item.message, str(item.status) == "proved")
        for item in gate.obligations
        if item.rule.id == "NRS108"
    }
    assert {key: met for key, (_, met) in shown.items()} == {
        key: met for key, (_, met) in obligations.items()
    }
    assert all(said in obligations[key][0] for key, (said, _) in shown.items())
    try:
        optimum = run_certified_optimum(designed, run_analysis(designed))
    except DesignError:
        assert not all(met for _, met in shown.values())
        assert recorded.design == designed.design
    else:
        assert all(met for _, met in goals_of(optimum.result).values())
        assert goals_of(optimum.result) == shown
        # It is the very certificate.
        assert optimum.result.certificate.id == read_document(gate.certificate)["id"]
        assert optimum.result.design == recorded.design
    return {key: met for key, (_, met) in shown.items() if key in STEERING}


ALONE = {"OTHER": "", "MOTOR": "4.8417e-4 rad/s/rpm", "LAG": "0.0351 s"}


@pytest.mark.parametrize(
    ("changes", "met"),
    [
        ({}, {"decay_rate": True}),
        # What no gains reach is said of those of the least cost.
        (ALONE | {"CONTACT": "kept", "GOALS": "decay_rate: 25 1/s"}, {"decay_rate": False}),
        # An older force than the spec declares is proved of it.
        (ALONE | {"GOALS": "decay_rate: 2 1/s, delay: 4 ms"}, {"decay_rate": True, "delay": True}),
    ],
)
def test_all_commands_agree(tmp_path, changes, met):
    assert agreed(written(tmp_path, **changes), tmp_path) == met


def test_ages_beyond_the_declared_ones_are_checked(tmp_path):
    """Of given gains, too, the goal `delay` is searched for; only a wider loop is taken for it."""
    fixed = {"MASSES": "Mt: 0.01 kg*m^2, Bt: 2.15 N*m*s/rad", "CONTACT": "kept"}
    loaded = read_spec(written(tmp_path, **(ALONE | fixed | {"GOALS": "delay: 4 ms"})))
    certificate = run_certification(loaded).certificate
    assert certificate.ages == (0, 2)
    assert goals_of_certificate(loaded, certificate)["delay"][1]
    document = json.loads(dump(certificate))
    assert verify_document(document, loaded).fault is None
    for ages, said in (
        ([0, 1], "'states' is not that of the spec"),
        ([1, 2], "not all those of the spec"),
        ([0, 11], "not all those of the spec"),
        ([0, True], "malformed"),
        (None, "'states' is not that of the spec"),
    ):
        forged = {key: value for key, value in document.items() if key != "ages"}
        forged |= {} if ages is None else {"ages": ages}
        assert said in verify_document(forged | {"id": content_id(forged)}, loaded).fault
