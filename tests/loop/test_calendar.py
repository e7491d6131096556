"""When commands take effect, against logs of commands that come at random times."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.loop.calendar import CommandTiming
from tests.tables import by_rows

F = Fraction
MS = F(1, 1000)


@pytest.mark.parametrize("periods", [0, 1, 3])
def test_whole_periods_leave_nothing_within_a_period(periods):
    timing = CommandTiming(2 * MS, periods * 2 * MS, periods * 2 * MS)
    assert timing.oldest == timing.newest == periods
    assert not [*timing.new_ages]
    assert not timing.varies


@by_rows("earliest", "latest", "left")
def test_what_is_left_of_a_period(earliest, latest, left):
    timing = CommandTiming(2 * MS, F(earliest) * MS, F(latest) * MS)
    assert [*timing.new_ages] == [*left]
    for age, ends in left.items():
        found = timing.time_left(age)
        assert (found.low, found.high) == tuple(F(end) * MS for end in ends)


def test_periods_of_several_lengths_count_as_the_shortest_and_the_longest():
    timing = CommandTiming(2 * MS, F(0), 2 * MS, jitter=MS / 10)
    assert (timing.lengths.low, timing.lengths.high) == (F("1.9") * MS, F("2.1") * MS)
    # A command of two periods, late by 2 ms, after two short ones.
    assert timing.oldest == 2
    assert timing.time_left(1).low == F("1.8") * MS


@given(
    st.integers(0, 2**32 - 1),
    st.fractions(0, 4, max_denominator=20),
    st.fractions(0, 3, max_denominator=20),
    st.sampled_from([F(0), F(1, 20), F(2, 5)]),
)
def test_no_log_of_commands_leaves_what_is_said(seed, earliest, more, jitter):
    """Latencies and periods at random, in units of the period: the newest that came is in force."""
    rng = np.random.default_rng(seed)
    timing = CommandTiming(F(1), earliest, earliest + more, jitter)
    low, high, off = map(float, (earliest, earliest + more, jitter))
    starts = np.cumsum(np.concatenate([[0.0], rng.uniform(1 - off, 1 + off, 30)]))
    comes = starts + rng.choice([low, high, *rng.uniform(low, high, 3)], len(starts))
    small = 1e-9
    for i in range(10, len(starts) - 1):
        begin, end = starts[i], starts[i + 1]
        # In force at the beginning: no older than said.
        assert min(comes[: i - timing.oldest + 1].min(), comes[i - timing.oldest]) <= begin + small
        if timing.newest:
            assert comes[i - timing.newest + 1 : i + 1].min() >= end - small
        for age in timing.new_ages:
            # From when on some command of this age or newer is in force.
            since = comes[i - age : i + 1].min()
            left, said = end - min(max(since, begin), end), timing.time_left(age)
            assert float(said.low) - small <= left <= float(said.high) + small
