"""The gradient iteration beside the LMI."""

from functools import partial

import pytest

from nrs_design.proof.mode import Time
from nrs_design.search.certification import Limits
from nrs_design.search.certify import certify
from nrs_design.search.comparison import compare_methods
from nrs_design.search.gradient_settings import Gradient
from nrs_design.search.method import Method
from tests.support import dayawansa_martin, family, holds

QUICK = Limits(optimize_rate=False, gradient=Gradient(max_updates=500))


@pytest.mark.parametrize(
    "system",
    [
        dayawansa_martin(5),
        family([["0.3", 0], ["0.3", 0]], [[0, "0.3"], [0, "-0.3"]], time=Time.DISCRETE),
    ],
)
def test_every_run_is_checked_and_tells_its_way(system):
    told = []
    lmi, *iterations = compare_methods(partial(certify, system), QUICK, told.append)
    assert told == [lmi.name, *(run.name for run in iterations)]
    assert len(iterations) == 6
    assert (lmi.method, lmi.updates) == (Method.LMI, None)
    for run in (lmi, *iterations):
        if run.certification.evidence:
            assert holds(system, run.certification.evidence)
            assert run.condition >= 1 - 1e-12
    for run in iterations:
        (history,) = run.histories
        assert (history[-1][1] <= 1e-9) == (run.certification.verdict == "proved")
        assert f"after {run.updates} updates" in run.outcome


def test_blocks_are_told_apart():
    one, two = [[-1, -1, 1], [1, -1, 1], [0, 0, -1]], [[-1, -5, 0], ["1/5", -1, 0], [0, 0, -3]]
    run = compare_methods(partial(certify, family(one, two)), QUICK)[1]
    assert len(run.histories) == 2
    assert run.updates == sum(history[-1][0] for history in run.histories)
    assert run.condition is None
    assert run.certification.verdict == "proved"


def test_a_refuted_mode_leaves_nothing_to_iterate():
    unstable = family([[1, 0], [1, -1]], [[-1, 1], [0, -1]])
    run = compare_methods(partial(certify, unstable), QUICK)[1]
    assert (run.certification.verdict, run.updates) == ("refuted", None)
    assert run.outcome == "not needed"
