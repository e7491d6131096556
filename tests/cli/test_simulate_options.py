"""Options of `nrs-design simulate` that exclude each other, or that nothing would heed."""

from dataclasses import replace
from pathlib import Path

import pytest
import typer

from nrs_design.cli.simulate_options import Many

NOTHING = Many(worst=False, runs=None, seed=0, jobs=1, resume=None)
UNSET = (None, None)


@pytest.mark.parametrize(
    ("asked", "of_scenarios", "hint"),
    [
        ({"worst": True, "runs": 3}, UNSET, "--worst-case, --monte-carlo"),
        ({"worst": True}, (["run"], None), "--worst-case"),
        ({"worst": True}, (None, 0), "--worst-case"),
        ({"jobs": 2}, UNSET, "--resume, --jobs"),
        ({"resume": Path("runs.jsonl")}, UNSET, "--resume, --jobs"),
        ({"worst": True, "jobs": 2}, UNSET, "--resume, --jobs"),
        ({"seed": 1}, UNSET, "--seed"),
    ],
)
def test_what_is_refused_is_named(asked, of_scenarios, hint):
    with pytest.raises(typer.BadParameter) as caught:
        replace(NOTHING, **asked).check(of_scenarios)
    assert caught.value.param_hint == hint


@pytest.mark.parametrize(
    ("asked", "of_scenarios"),
    [
        ({}, (["run"], 0.002)),
        ({"worst": True, "seed": 1}, UNSET),
        ({"worst": True}, ([], None)),
        ({"runs": 3, "seed": 1, "jobs": 2, "resume": Path("runs.jsonl")}, (["run"], 0.002)),
    ],
)
def test_what_goes_together_passes(asked, of_scenarios):
    replace(NOTHING, **asked).check(of_scenarios)
