"""Goals at the end of `optimize` and `tune`: the exit code and what a program reads."""

import math
from types import SimpleNamespace

import pytest

from nrs_design.cli.goals import exit_code, goals_summary, print_goals
from nrs_design.design.goals import Achieved
from nrs_design.design.measures import DELAY_MARGIN, GAIN_MARGIN, PHASE_MARGIN


def item(*achieved):
    return SimpleNamespace(name="insertion", achieved=achieved)


FREE = Achieved(GAIN_MARGIN, 1.0, "soft")
MET = Achieved(GAIN_MARGIN, 2.0, "soft", 2.0)
MISSED = Achieved(GAIN_MARGIN, 1.999, "soft", 2.0)


@pytest.mark.parametrize(
    ("items", "code"),
    [([], 0), ([item(FREE)], 0), ([item(MET, FREE)], 0), ([item(MET), item(FREE, MISSED)], 1)],
)
def test_one_missed_goal_decides(items, code):
    assert exit_code(items) == code


def test_a_document_holds_si_units_and_no_infinity():
    endless = Achieved(DELAY_MARGIN, math.inf, "soft", 0.1)
    delay, phase = goals_summary(item(endless, Achieved(PHASE_MARGIN, 1.0, "stiff")))
    assert (delay["worst"], delay["unit"], delay["status"]) == (None, "s", "met")
    assert (phase["worst"], phase["unit"], phase["status"]) == (1.0, "rad", None)


def test_only_goals_that_are_set_are_printed(capsys):
    print_goals("s", [item(FREE)])
    assert capsys.readouterr().out == ""
    print_goals("s", [item(FREE, MISSED)])
    assert capsys.readouterr().out.count("MISSED") == 1
