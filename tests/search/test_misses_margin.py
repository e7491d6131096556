"""Both ends of the number of misses are found, whatever the spec declares."""

import pytest

from nrs_design.certificates.certificate import Verdict
from nrs_design.search.loop_margin import find_most_misses


class Decide:
    """Proved up to a number, refuted from another one on; nothing beyond a last one."""

    def __init__(self, proved, refuted, last=100):
        self.proved, self.refuted, self.last, self.asked = proved, refuted, last, []

    def __call__(self, number):
        assert number >= 1
        self.asked.append(number)
        if number > self.last:
            return "too many states"
        if number <= self.proved:
            return Verdict.PROVED
        return Verdict.REFUTED if number >= self.refuted else Verdict.INCONCLUSIVE


class Found:
    def __init__(self, verdict):
        self.verdict, self.refuted_in = verdict, None


@pytest.mark.parametrize("declared", range(1, 12))
@pytest.mark.parametrize(("proved", "refuted"), [(0, 1), (0, 4), (3, 4), (3, 7), (9, 12), (5, 99)])
def test_both_ends(declared, proved, refuted):
    decide = Decide(proved, refuted)
    found = find_most_misses(declared, 12, lambda number: Found(decide(number)))
    assert found.proved == (proved or None)
    assert found.refuted == (refuted if refuted <= 12 else None)
    assert len(decide.asked) == len(set(decide.asked)) <= 10
    assert bool(found.end) is (refuted > 12)


def test_numbers_that_make_no_system_are_neither():
    decide = Decide(2, 99, last=6)

    def found(number):
        verdict = decide(number)
        return verdict if isinstance(verdict, str) else Found(verdict)

    ends = find_most_misses(2, 12, found)
    assert (ends.proved, ends.refuted) == (2, None)
    assert ends.end == "none of up to 6 is refuted: more make no system (too many states)"


def test_what_is_known_is_not_decided_again():
    decide = Decide(3, 5)
    find_most_misses(3, 12, lambda number: Found(decide(number)), Found(Verdict.PROVED))
    assert 3 not in decide.asked
