"""Dwell times in sampled loops: the automaton allows what they allow, and nothing else."""

from fractions import Fraction
from itertools import pairwise, product

import pytest

from nrs_design.errors import AssemblyError
from nrs_design.loop.assemble import assemble
from nrs_design.loop.stays import count_stays
from nrs_design.pipeline.runs import run_design
from nrs_design.spec import SwitchingSpec
from tests.loop.support import assembled, loaded
from tests.support import words_of

MODES = {"a": ["a/1", "a/2"], "b": ["b"], "c": ["c"]}


def counted(rules: dict, period="1/2", modes=MODES):
    return count_stays(SwitchingSpec.model_validate(rules), modes, Fraction(period)).clock


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
        ({"dwell_time": "1 s"}, {"a": 2, "b": 2, "c": 2}),
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


def test_stays_of_too_many_samples_are_refused_with_what_to_write():
    """To count fewer would prove less than is asked, and refute what is not there."""
    with pytest.raises(AssemblyError, match="2003 samples long, at most 1000") as refused:
        counted({"dwell_time": {"a": "1000 s", "b": "1 s"}})
    assert "333 samples each, which is 166.5 s" in refused.value.remedy


SPEC = """
kind: interaction-design
name: stays
title: Stays
position_interface: {time_constant: 0.01 s}
limits: {velocity: 8 deg/s, torque: 0.3 N*m, bandwidth: 2 Hz}
environments:
  soft: {model: elastic, stiffness: {nominal: 20 N*m/rad, range: [5 N*m/rad, 100 N*m/rad]}}
controllers:
  firm: {type: impedance, environment: soft, Mt: 0.3 kg*m^2, Bt: 3 N*m*s/rad}
  mild: {type: impedance, environment: soft, Mt: 0.2 kg*m^2, Bt: 3 N*m*s/rad}
sampling: {period: 10 ms, delay: 1, jitter: 2 ms}
contact: kept
switching: {dwell_time: 0.1 s}
"""
ALONE = "  mild: {type: impedance, environment: soft, Mt: 0.2 kg*m^2, Bt: 3 N*m*s/rad}\n", ""


def test_a_dwell_time_of_a_controller_is_none_of_its_modes():
    """The tissue may change at every sample: one controller alone is as if switching were free."""
    alone = assembled(SPEC, ALONE)
    free = assembled(SPEC, ALONE, ("{dwell_time: 0.1 s}", "arbitrary"))
    assert alone.clock is None
    assert alone.switching == free.switching
    two = assembled(SPEC)
    assert two.switching.is_arbitrary
    assert two.clock.length == 2 * 9
    assert "at least so many samples: firm 9, mild 9" in " ".join(words_of(two))


def test_at_points_a_period_has_its_length():
    """A word of so many samples there is shorter in time than with the longest periods."""
    found = run_design(loaded(SPEC))
    system = assemble(found.spec, found.plant, found.design, points="ends")
    assert system.clock.length == 2 * 10
