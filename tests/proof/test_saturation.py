"""Signals that saturate: what makes no sense of them, and what lies between their limits."""

from dataclasses import replace
from fractions import Fraction

import pytest

from nrs_design.proof.contradiction import find_contradiction
from tests.proof.systems import genuine, matrix, pushed_away

WHAT = pushed_away().saturation
(SIGNAL,) = WHAT.signals


def several(count):
    rows = (matrix([[-3] + [0] * i]) for i in range(count))
    signals = (replace(SIGNAL, name=f"s{i}", rows=(row,)) for i, row in enumerate(rows))
    return replace(WHAT, signals=tuple(signals))


def test_up_to_four_signals_make_sense():
    assert WHAT.find_oddity(1, 1, 0) is None
    assert several(4).find_oddity(1, 1, 0) is None
    assert several(5).find_oddity(1, 1, 0) == "more than 4 signals saturate"


@pytest.mark.parametrize("signals", [(), (SIGNAL, SIGNAL)])
def test_there_is_a_signal_and_each_has_its_name(signals):
    assert "no signal saturates" in replace(WHAT, signals=signals).find_oddity(1, 1, 0)


def test_a_motion_that_begins_at_zero_says_nothing():
    nowhere = replace(WHAT, start=replace(WHAT.start, states=(matrix([[1]]), matrix([[0]]))))
    assert "stands for a state that is zero" in nowhere.find_oddity(1, 1, 0)


def test_a_motion_begins_in_contact_where_that_can_be_lost():
    """With a negative deflection, x'Qx may be smaller than V, which is of (y, 0)."""
    system, evidence = genuine("saturated-ellipsoid")
    start = replace(system.saturation.start, states=(matrix([[1], [Fraction(-1, 8)]]),))
    away = replace(system, saturation=replace(system.saturation, start=start))
    assert "stands for a state without contact" in find_contradiction(away)
    assert evidence.find_fault(system) is None


def test_every_choice_is_a_matrix():
    held = [[Fraction(-17, 16)]]
    found = [B.fractions() for B in WHAT.between(matrix([[-2]]), 0, held)]
    assert found == [[[-2]], [[Fraction(-1, 16)]]]
