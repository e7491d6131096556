"""Predictions decide what is begun, the clock what is stopped; a part shares with the whole."""

from math import inf

import pytest

from nrs_design.certificates.search.allowance import Allowance, Cost, NotAffordableError


class Clock:
    """A clock that a test sets."""

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
    assert allowance.unplanned == inf
    assert allowance.goes_on(1e9)


def test_what_does_not_fit_is_not_begun(clock):
    allowance = Allowance(10.0, 2e9, clock)
    allowance.take(Cost(6.0, 2e9), "one program")
    with pytest.raises(NotAffordableError, match=r"another program .* 5 s, and 4 s of .* 10 s"):
        allowance.take(Cost(5.0), "another program")
    with pytest.raises(NotAffordableError, match=r"3 GB .* 2 GB are allowed \(--memory\)"):
        allowance.require(Cost(0.1, 3e9), "a large one")
    assert allowance.unplanned == 4.0


def test_a_faster_clock_changes_nothing_about_what_is_begun(clock):
    """Only the predicted time counts, until the clock has run out."""
    allowance = Allowance(10.0, clock=clock)
    clock.now += 9.9
    allowance.take(Cost(9.0), "a program")
    assert allowance.unplanned == pytest.approx(1.0)
    clock.now += 0.2
    assert not allowance.goes_on()
    with pytest.raises(NotAffordableError, match=r"stopped: the budget of 10 s .*--budget"):
        allowance.require(Cost(0.5), "a program")


def test_a_part_ends_before_the_whole_and_is_charged_to_it(clock):
    whole = Allowance(10.0, 5.0, clock)
    whole.charge(2.0)
    part = whole.part(0.5)
    assert (part.unplanned, part.memory, part.total) == (4.0, 5.0, 10.0)
    assert not part.goes_on(4.0)
    with pytest.raises(NotAffordableError, match="its share of the budget of 10 s"):
        part.check()
    assert whole.unplanned == 4.0
    assert whole.goes_on()


def test_a_part_has_no_more_time_than_the_whole(clock):
    whole = Allowance(10.0, clock=clock)
    clock.now += 9.0
    part = whole.part(0.5)
    assert part.left == 1.0
    clock.now += 1.0
    with pytest.raises(NotAffordableError, match="stopped: the budget"):
        part.check()
