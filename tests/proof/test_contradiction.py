"""Systems that contradict themselves, and others: the rows of test_contradiction.yaml."""

from dataclasses import replace

import pytest

from nrs_design.proof.contradiction import find_contradiction
from nrs_design.proof.switching import Clock
from tests.proof.rows import cases, check
from tests.proof.systems import doubled_in_turns, saturating


@pytest.mark.parametrize("case", cases(__file__))
def test_what_a_row_says(case):
    check(case)


def test_a_rule_for_misses_is_said_of_every_state_for_both_kinds():
    rule = Clock(2, ("m0",), ((0, 1), (0,)))
    found = find_contradiction(replace(doubled_in_turns(3), clock=rule))
    assert "not said of every state" in found


@pytest.mark.parametrize(("count", "words"), [(5, "or more than 4 do"), (4, "does not have the")])
def test_few_signals_saturate(count, words):
    system = saturating()
    signals = system.saturation.signals[:1] * count
    odd = replace(system, saturation=replace(system.saturation, signals=signals))
    assert words in find_contradiction(odd)
