"""Rules for missed deadlines: their words, counted and compared with every window."""

from itertools import product

import pytest

from nrs_design.spec.misses import automaton_of


def follow(automaton, word):
    """Return the state after a word of misses (1) and hits (0); None if it is not allowed."""
    state = 0
    for missed in word:
        state = automaton.miss[state] if missed else automaton.hit[state]
        if state is None:
            return None
    return state


@pytest.mark.parametrize(("at_most", "of"), [(1, 2), (1, 3), (2, 4), (2, 5), (3, 4), (4, 6)])
def test_words_are_those_that_every_window_allows(at_most, of):
    automaton = automaton_of(at_most, of)
    for length in range(1, 11):
        for word in product((0, 1), repeat=length):
            windows = (word[i : i + of] for i in range(max(1, length - of + 1)))
            allowed = all(sum(window) <= at_most for window in windows)
            assert (follow(automaton, word) is not None) is allowed
