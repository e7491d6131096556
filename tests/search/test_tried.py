"""What was tried: nothing is decided twice, and what is known is told."""

from fractions import Fraction

from nrs_design.certificates.certificate import Verdict
from nrs_design.search.tried import Tried, sharpen


def test_nothing_is_decided_twice():
    asked, told = [], []

    def decide(number):
        asked.append(number)
        return Verdict.PROVED if number < 3 else "too long"

    tried = Tried(decide, told.append, "period", "s")
    tried.remember(Fraction(1), Verdict.REFUTED)
    assert tried.is_refuted(Fraction(1))
    for _ in range(2):
        assert tried.is_proved(Fraction(2))
        assert not tried.is_refuted(Fraction(4))
        assert tried.makes_no_system(Fraction(4))
    assert asked == [2, 4]
    assert told == ["period 2 s (refuted: 1 s)", "period 4 s (proved: 2 s, refuted: 1 s)"]
    assert (tried.all(), tried.that_are(Verdict.PROVED)) == ([1, 2, 4], [2])


def test_where_it_ends_is_told_with_the_fault_next_to_it():
    tried = Tried(lambda number: Verdict.PROVED if number < 3 else f"{number} is too long")
    assert tried(1) is Verdict.PROVED
    assert (
        tried.end("up to", "longer ones fail") == "none up to 1 is refuted: the search ends there"
    )
    for number in (5, 2, 4):
        tried(number)
    assert (tried.longest(), tried.fault()) == (2, "4 is too long")
    assert (
        tried.end("up to", "longer fail") == "none up to 2 is refuted: longer fail (4 is too long)"
    )


def test_bisection_ends_at_what_is_accepted():
    found = sharpen(Fraction(0), Fraction(1), 5, lambda number: number <= Fraction(2, 5))
    assert 0 <= Fraction(2, 5) - found < Fraction(1, 32)
