"""The pair of Dayawansa and Martin (1999) at a = 6 beside a decoupled stable state.

The block has no common quadratic function, so the whole has none; but no dual certificate is
strict in the decoupled coordinate.
"""

from .known import known, never_contradict


def test_a_decoupled_state_changes_nothing():
    assert (
        never_contradict("degenerate-dual").verdict
        == never_contradict("dayawansa-martin-6").verdict
    )


def test_the_block_is_that_of_dayawansa_and_martin():
    blocks = [
        [row[1:] for row in mode.A.fractions()[1:]]
        for mode in known("degenerate-dual").system.modes
    ]
    assert blocks == [mode.A.fractions() for mode in known("dayawansa-martin-6").system.modes]
