"""Goals at the end of `optimize` and `tune`: the exit code and what a program reads."""

import math
from types import SimpleNamespace

import pytest

from nrs_design.cli.goals import design_answer
from nrs_design.design.goals import Achieved
from nrs_design.design.laws.law import AbstractControllerAnalysis
from nrs_design.design.measures import DELAY_MARGIN, GAIN_MARGIN, PHASE_MARGIN
from nrs_design.facts.goals import goals_summary
from nrs_design.spec import read_spec
from tests.support import SOFT_TISSUE


@pytest.fixture
def designed():
    loaded = read_spec(SOFT_TISSUE)
    return SimpleNamespace(loaded=loaded, spec=loaded.spec)


def item(*achieved):
    return AbstractControllerAnalysis("insertion", achieved)


FREE = Achieved(GAIN_MARGIN, 1.0, "soft")
MET = Achieved(GAIN_MARGIN, 2.0, "soft", 2.0, everywhere=True)
OPEN = Achieved(GAIN_MARGIN, 2.0, "soft", 2.0)
MISSED = Achieved(GAIN_MARGIN, 1.999, "soft", 2.0)


@pytest.mark.parametrize(
    ("items", "code", "missed"),
    [
        ([], 0, 0),
        ([item(FREE)], 0, 0),
        ([item(MET, FREE)], 0, 0),
        ([item(MET), item(FREE, MISSED)], 1, 1),
        ([item(OPEN), item(MISSED)], 1, 1),
        ([item(MET, OPEN)], 3, 0),
    ],
)
def test_one_missed_goal_decides_and_only_goals_that_are_set_are_printed(
    designed, capsys, items, code, missed
):
    answer = design_answer(designed, SimpleNamespace(warnings=()), items, dict, lambda: None)
    answer.show()
    assert answer.code == code
    shown = capsys.readouterr().out
    assert shown.count("MISSED") == missed
    assert ("wanted" in shown) == (code > 0 or (len(items) == 1 and MET in items[0].achieved))
    assert answer.facts().keys() == {"spec", "spec_sha256", "warnings"}


def test_a_document_holds_si_units_and_no_infinity():
    endless = Achieved(DELAY_MARGIN, math.inf, "soft", 0.1, everywhere=True)
    delay, phase = goals_summary(item(endless, Achieved(PHASE_MARGIN, 1.0, "stiff")))
    assert (delay["worst"], delay["unit"], delay["status"]) == (None, "s", "met")
    assert (phase["worst"], phase["unit"], phase["status"]) == (1.0, "rad", None)
