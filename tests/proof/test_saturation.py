"""Signals that saturate: what makes no sense of them, and what lies between their limits."""

from dataclasses import replace
from fractions import Fraction

import pytest

from nrs_design.proof.between import between
from nrs_design.proof.contact import Contact
from nrs_design.proof.contradiction import find_contradiction
from nrs_design.proof.mode import Mode
from nrs_design.proof.saturation import CutOff, Saturation
from tests.proof.systems import family, matrix, pushed_away

WHAT = pushed_away().saturation
NEITHER = "no signal saturates, or more than 4 do"
(SIGNAL,) = WHAT.signals


def several(count):
    rows = (matrix([[-3] + [0] * i]) for i in range(count))
    signals = (replace(SIGNAL, name=f"s{i}", rows=(row,)) for i, row in enumerate(rows))
    return replace(WHAT, signals=tuple(signals))


def oddity_of(system, what):
    return find_contradiction(replace(system, saturation=what))


def test_up_to_four_signals_of_different_names_make_sense():
    system = pushed_away()
    for count, oddity in ((1, None), (4, None), (5, NEITHER), (0, NEITHER)):
        assert oddity_of(system, several(count)) == oddity
    named = tuple(replace(signal, name="s") for signal in several(2).signals)
    assert oddity_of(system, replace(WHAT, signals=named)) == "s is said twice"


def test_the_last_state_is_the_deflection():
    column, row = matrix([[1], [0], [0]]), matrix([[-1, 0, 0]])
    signal = replace(SIGNAL, columns=(column,) * 2, rows=(row,) * 2)
    for start, oddity in (
        ([[0], [-1], [1]], None),
        ([[0], [1], [-1]], "place stands for a state without contact"),
    ):
        states = (matrix(start),)
        what = Saturation((signal,), replace(WHAT.start, states=states))
        still = [[0] * 3] * 3
        system = replace(family(still), contact=Contact((Mode("free", matrix(still)),)))
        assert oddity_of(system, what) == oddity


def choices(what, A, held):
    system = between(replace(family(A), saturation=what), [held])
    return [mode.A.fractions() for mode in system.modes]


def test_every_choice_is_a_matrix():
    held = [[Fraction(-17, 16)]]
    assert choices(WHAT, [[-2]], held) == [[[-2]], [[Fraction(-1, 16)]]]


def test_a_signal_in_another_is_replaced_in_it_too():
    """By hand: x' = x + s1 + s2 with s1 = sat(-x) and s2 = sat(s1 - x)."""
    s1 = CutOff(
        name="s1", unit="N", limit=Fraction(2), columns=(matrix([[1]]),), rows=(matrix([[-1]]),)
    )
    s2 = CutOff(
        name="s2", unit="N", limit=Fraction(1), columns=(matrix([[1]]),), rows=(matrix([[-1, 1]]),)
    )
    what = Saturation((s1, s2), WHAT.start)
    found = choices(what, [[-2]], [[Fraction(-1, 2)], [Fraction(-3, 4)]])
    # s1 in {-x, -x/2}; s2 in {s1 - x, -3x/4}.
    assert [entry for ((entry,),) in found] == [
        1 - 1 - 2,
        1 - 1 - Fraction(3, 4),
        1 - Fraction(1, 2) - Fraction(3, 2),
        1 - Fraction(1, 2) - Fraction(3, 4),
    ]


LONGER = replace(SIGNAL, rows=(matrix([[-3, 0, 0]]),))


@pytest.mark.parametrize(
    ("what", "A", "held"),
    [
        (WHAT, [[-2]], []),
        (WHAT, [[-2]], [[-1], [-1]]),
        (WHAT, [[-2]], [[-1, 0]]),
        (WHAT, [[-2, 0], [0, -2]], [[-1]]),
        (replace(WHAT, signals=(SIGNAL, LONGER)), [[-5]], [[-1], [-1]]),
    ],
)
def test_rows_that_do_not_fit_are_an_error(what, A, held):
    with pytest.raises(ValueError, match="zip"):
        choices(what, A, held)
