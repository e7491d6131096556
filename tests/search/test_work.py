"""Counts decide what is begun and where it ends; the clock is a fuse; a part shares the whole."""

from itertools import count
from math import inf

import pytest

from nrs_design.errors import ClockError
from nrs_design.search.work import Allowance, Cost, Fuse, NotAffordableError


class Clock:
    def __init__(self):
        self.now = 100.0

    def __call__(self):
        return self.now


@pytest.fixture
def clock():
    return Clock()


def test_without_limits_everything_fits():
    allowance = Allowance()
    allowance.take(Cost(1e9, 1e18), "a program")
    assert allowance.left == inf
    assert allowance.goes_on(1e9)
    assert allowance.charged == 2e9


def test_what_does_not_fit_is_not_begun():
    allowance = Allowance(10.0, 2e9)
    allowance.take(Cost(6.0, 2e9), "one program")
    with pytest.raises(NotAffordableError, match=r"another program .* 5 of work, and 4 of .* 10 "):
        allowance.take(Cost(5.0), "another program")
    with pytest.raises(NotAffordableError, match=r"3 GB .* 2 GB are allowed \(--memory\)"):
        allowance.require(Cost(0.1, 3e9), "a large one")
    assert allowance.left == 4.0


@pytest.mark.parametrize("pace", [0.0, 1e-3, 5.0])
def test_no_pace_of_the_clock_changes_what_fits(pace):
    """Below its fuse; the work alone says when a search ends."""
    ticks = (pace * tick for tick in count())
    allowance = Allowance(10.0, fuse=Fuse.of(10.0, clock=lambda: next(ticks)))
    made = 0
    while allowance.goes_on(1.0):
        made += 1
    assert made == 9
    with pytest.raises(NotAffordableError, match=r"stopped: the budget of 10 is .*--budget"):
        allowance.require(Cost(0.0), "a program")


def test_a_blown_fuse_is_an_error_and_no_end_of_a_search(clock):
    allowance = Allowance(10.0, fuse=Fuse.of(10.0, clock=clock))
    clock.now += 159.9
    assert allowance.part(0.5).goes_on(1.0)
    clock.now += 0.2
    for charged in (allowance.part(0.5).check, allowance.goes_on, lambda: allowance.charge(1.0)):
        with pytest.raises(ClockError, match="the clock stopped this after 160 s") as caught:
            charged()
    assert "nothing was decided" in caught.value.message
    assert not isinstance(caught.value, NotAffordableError)


def test_a_budget_without_end_has_no_fuse():
    assert Fuse.of(inf).left == inf


def test_a_part_ends_before_the_whole_and_is_charged_to_it():
    whole = Allowance(10.0, 5.0)
    whole.charge(2.0)
    part = whole.part(0.5)
    assert (part.left, part.memory, part.total) == (4.0, 5.0, 10.0)
    assert not part.goes_on(4.0)
    with pytest.raises(NotAffordableError, match="its share of the budget of 10 "):
        part.check()
    assert whole.left == 4.0
    assert whole.goes_on()


def test_a_part_has_no_more_than_the_whole():
    whole = Allowance(10.0)
    part = whole.part(0.5)
    whole.charge(9.0)
    assert part.left == 1.0
    whole.charge(1.0)
    with pytest.raises(NotAffordableError, match="stopped: the budget"):
        part.check()
