"""Both ends of the longest time of an interval are found, whatever the spec declares."""

from fractions import Fraction

import pytest

from nrs_design.certificates.certificate import Verdict
from nrs_design.search.timing_margin import find_longest_time


class Found:
    def __init__(self, verdict):
        self.verdict, self.refuted_in = verdict, None


def decider(proved, refuted, asked):
    """Proved up to a time, refuted from another one on."""

    def decide(time):
        assert time not in asked
        asked.append(time)
        if time <= proved:
            return Found(Verdict.PROVED)
        return Found(Verdict.REFUTED if time >= refuted else Verdict.INCONCLUSIVE)

    return decide


@pytest.mark.parametrize("declared", ["1", "2", "3", "5", "9"])
@pytest.mark.parametrize(("proved", "refuted"), [("2.5", "2.5"), ("2.5", "4"), ("3.1", "8")])
def test_both_ends(declared, proved, refuted):
    asked, ends = [], (Fraction(proved), Fraction(refuted))
    found = find_longest_time(
        "period", Fraction(1), Fraction(declared), None, decider(*ends, asked)
    )
    assert found.proved <= ends[0] <= found.proved + Fraction(1, 4)
    assert found.refuted - Fraction(1, 4) <= ends[1] <= found.refuted
    assert len(asked) <= 20


def test_none_is_proved():
    found = find_longest_time("period", Fraction(1), Fraction(4), None, decider(0, 2, []))
    assert found.proved is None
    assert found.refuted <= Fraction(2) + Fraction(1, 10)


def test_none_is_refuted():
    found = find_longest_time("delay", Fraction(0), Fraction(1), Fraction(3), decider(2, 9, []))
    assert (Fraction(2) - Fraction(1, 10) <= found.proved <= 2, found.refuted) == (True, None)
    assert found.end == "none of up to 3 s is refuted: the search ends there"


def test_all_are_proved():
    found = find_longest_time("delay", Fraction(0), Fraction(1), Fraction(3), decider(9, 9, []))
    assert (found.proved, found.refuted) == (3, None)


def test_what_is_known_is_not_decided_again():
    asked = []
    known = Found(Verdict.PROVED)
    find_longest_time("delay", Fraction(0), Fraction(1), Fraction(3), decider(2, 9, asked), known)
    assert Fraction(1) not in asked
