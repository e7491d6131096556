"""Runs of the sampled engine that miss deadlines, as the rule of the spec allows."""

from itertools import groupby

import numpy as np
import pytest

from nrs_design.errors import DesignError
from nrs_design.pipeline.runs import run_design
from nrs_design.pipeline.scenarios import Runs, run_scenarios
from nrs_design.simulation.build_scenario import default_scenario
from nrs_design.simulation.sampled_axis import draw_samples
from nrs_design.spec import read_spec
from nrs_design.spec.misses import DeadlinesSpec
from tests.support import SOFT_TISSUE, spec_in


def designed(path, misses):
    text = SOFT_TISSUE.read_text(encoding="utf-8")
    rule = f", misses: {misses}" if misses else ""
    path = spec_in(path, f"{text}\nsampling: {{period: 2 ms, delay: [0, 1]{rule}}}\n", "missing")
    return run_design(read_spec(path))


@pytest.mark.parametrize(
    ("rule", "most", "of"), [({"consecutive": 3}, 3, 4), ({"at_most": 2, "of": 10}, 2, 10)]
)
def test_what_is_drawn_keeps_the_rule(tmp_path, rule, most, of):
    """And it is not kept by far: some windows have as many misses as they may."""
    given = designed(tmp_path, "")
    scenario = default_scenario(given.spec, given.plant)
    misses = DeadlinesSpec.model_validate({**rule, "command": "hold"})
    sampling = given.spec.sampling
    missing = sampling.model_copy(update={"misses": misses})
    drawn, plain = (draw_samples(scenario, s, (0.0, 0.0), 4000) for s in (missing, sampling))
    missed = np.array([sample.missed for sample in drawn])
    assert np.lib.stride_tricks.sliding_window_view(missed, of).sum(axis=1).max() == most
    assert [sample._replace(missed=False) for sample in drawn] == plain


@pytest.mark.parametrize("command", ["hold", "zero"])
def test_a_missed_period_computes_nothing(tmp_path, command):
    given = designed(tmp_path, f"{{consecutive: 2, command: {command}}}")
    (one,) = run_scenarios(given, Runs(max_steps=2000))
    response = one.run.response
    rows, states = response.signals, response.x
    # The states of the law are those before a sample: a missed one leaves them.
    idle = (states[:, 1:] == states[:, :-1]).all(axis=0)
    moving = np.abs(rows["velocity"][:-1]) > 1e-3
    missed = idle & moving
    assert 0 < missed.sum() <= one.run.missed
    runs = [len([*same]) for value, same in groupby(missed.tolist()) if value]
    assert max(runs) == 2
    after = rows["command"][:-1][missed]
    if command == "zero":
        assert not after.any()
    else:
        before = np.concatenate([[0.0], rows["command"][:-2]])[missed]
        assert (after == before).all()


def test_two_periods_do_not_miss(tmp_path):
    given = designed(tmp_path, "{consecutive: 2, command: hold}")
    with pytest.raises(DesignError, match="one period of all loops"):
        [*run_scenarios(given, Runs(outer_period=0.004))]
