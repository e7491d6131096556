"""The pair of Dayawansa and Martin (1999) at a = 6 beside a decoupled stable state.

The block has no common quadratic function, so the whole has none; but no dual certificate is
strict in the decoupled coordinate.
"""

from .known import known, settle


def test_a_decoupled_state_changes_nothing():
    whole, block = settle("degenerate-dual"), settle("dayawansa-martin-6")
    assert whole.evidence.kind == "block-triangular"
    degrees = [part.degree for _, part in whole.evidence.parts if part.degree > 1]
    assert degrees == [block.evidence.degree]


def test_the_block_is_that_of_dayawansa_and_martin():
    blocks = [
        [row[1:] for row in mode.A.fractions()[1:]]
        for mode in known("degenerate-dual").system.modes
    ]
    assert blocks == [mode.A.fractions() for mode in known("dayawansa-martin-6").system.modes]
