"""Dwell times in sampled loops: the automaton allows what they allow, and nothing else."""

from fractions import Fraction
from itertools import pairwise, product

import pytest

from nrs_design.loop.stays import MOST_STATES, clock_of_stays
from nrs_design.spec import SwitchingSpec

MODES = {"a": ["a/1", "a/2"], "b": ["b"], "c": ["c"]}


def counted(rules: dict, period="1/2", modes=MODES):
    return clock_of_stays(SwitchingSpec.model_validate(rules), modes, Fraction(period))


def lasts(word: str, counts: dict[str, int], pairs) -> bool:
    """Tell whether every stay but the first and the last is as long as it must be."""
    runs = [[word[0], 1]]
    for before, name in pairwise(word):
        if name == before:
            runs[-1][1] += 1
        else:
            if pairs is not None and (before, name) not in pairs:
                return False
            runs.append([name, 1])
    return all(count >= counts[name] for name, count in runs[1:-1])


@pytest.mark.parametrize(
    ("rules", "counts"),
    [
        ({"dwell_time": "1.5 s"}, {"a": 3, "b": 3, "c": 3}),
        # A stay of 1.1 s is one of three samples, of 0.1 s of one.
        ({"dwell_time": {"a": "1.1 s", "b": "0.1 s"}}, {"a": 3, "b": 1, "c": 1}),
        ({"dwell_time": "2 steps"}, {"a": 2, "b": 2, "c": 2}),
        (
            {"dwell_time": {"a": "1 s"}, "transitions": [["a", "b"], ["b", "c"], ["c", "a"]]},
            {"a": 2, "b": 1, "c": 1},
        ),
    ],
)
def test_every_word_of_seven_samples(rules, counts):
    clock = counted(rules)
    assert (clock.first, clock.more) == (("a/1", "a/2"), (("b",),))
    pairs = SwitchingSpec.model_validate(rules).transitions
    for word in map("".join, product("abc", repeat=7)):
        kinds = ["abc".index(name) for name in word]
        found = False
        for state in range(clock.length):
            for kind in kinds:
                state = None if state is None else clock.after(state, kind)
            found = found or state is not None
        assert found is lasts(word, counts, pairs), word


def test_without_long_stays_there_is_no_automaton():
    assert counted({"dwell_time": "0.5 s"}) is None
    assert counted({"transitions": [["a", "b"]]}) is None
    assert counted({"dwell_time": "5 s"}, modes={"a": ["a"]}) is None


def test_long_stays_are_counted_up_to_a_limit():
    """That allows for more signals than there are."""
    clock = counted({"dwell_time": {"a": "1000 s", "b": "1 s"}})
    assert clock.length == MOST_STATES // 3 + 2 + 1
