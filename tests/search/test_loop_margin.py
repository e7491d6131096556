"""How far delay, period and disturbances stretch: every verdict that a bracket may meet."""

from fractions import Fraction

import pytest

from nrs_design.certificates.certificate import Verdict
from nrs_design.search.loop_margin import (
    Bracket,
    command_margin,
    find_longest_delay,
    find_longest_period,
)
from tests.proof.evidence.test_invariant_ellipsoid import BOUNCE
from tests.proof.systems import bouncing, pushed

P, R, N = Verdict.PROVED, Verdict.REFUTED, Verdict.INCONCLUSIVE


def unstable_from(first, where=""):
    return lambda delay: where if delay >= first else None


@pytest.mark.parametrize(
    ("verdicts", "shortest", "declared", "unstable", "expected"),
    [
        ("PPIR", 0, 1, 99, (1, 3)),
        ("PPPP", 0, 1, 99, (3, None)),
        ("PPPP", 0, 1, 21, (3, 21)),
        ("PPPP", 0, 1, 32, (3, 32)),
        ("PPII", 0, 1, 4, (1, 4)),
        ("PPII", 0, 1, 3, (1, 3)),
        ("PPIP", 0, 1, 33, (3, None)),
        ("PRRR", 0, 2, 99, (0, 1)),
        ("PIRR", 0, 2, 99, (0, 2)),
        ("RRRR", 0, 0, 99, (None, 0)),
        ("IIII", 1, 2, 99, (None, None)),
        ("IIIR", 1, 2, 99, (None, 3)),
    ],
)
def test_the_longest_delay(verdicts, shortest, declared, unstable, expected):
    """Beyond three samples, those from `unstable` on are refuted by a quick test alone."""
    asked = []

    def decide(delay: int) -> Verdict:
        asked.append(delay)
        return {"P": P, "R": R, "I": N}[verdicts[delay]]

    found = find_longest_delay(shortest, declared, 3, decide, unstable_from(unstable))
    assert (found.proved, found.refuted) == expected
    assert ("up to 32 samples" in found.end) == (found.refuted is None)
    # Nothing is asked twice, and nothing below what is declared is possible.
    assert len(set(asked)) == len(asked)
    assert min(asked) >= shortest


@pytest.mark.parametrize("declared", [0, 2])
@pytest.mark.parametrize(
    ("verdicts", "expected"),
    [
        ("PPPPPPPPPPP", (10, None)),
        ("PPPIIIIIIII", (2, None)),
        ("PPPPPPIIIRR", (5, 9)),
        ("PPPRRRRRRRR", (2, 3)),
        ("PPPIRRRRRRR", (2, 4)),
        ("PPPIIIIIIIR", (2, 10)),
    ],
)
def test_the_longest_delay_takes_few_decisions(verdicts, declared, expected):
    """Every decision may take 10 s: beyond the declared delay they are bisected."""
    asked = []

    def decide(delay: int) -> Verdict:
        asked.append(delay)
        return {"P": P, "R": R, "I": N}[verdicts[delay]]

    found = find_longest_delay(0, declared, 10, decide, lambda delay: None)
    assert (found.proved, found.refuted) == expected
    assert len(asked) == len(set(asked)) <= 8


def test_a_shortest_delay_that_is_refuted_below_one_that_is_open():
    found = find_longest_delay(0, 1, 2, {0: R, 1: N, 2: P}.__getitem__, lambda delay: None)
    assert found.refuted == 0


def test_a_delay_that_makes_no_loop_is_told():
    """Neither a proof nor a refutation: what is decided below it stands, and the search goes on."""
    found = find_longest_delay(
        0, 1, 10, lambda delay: P if delay <= 4 else "too large", unstable_from(12)
    )
    assert found == Bracket(Fraction(4), Fraction(12))
    found = find_longest_delay(
        0, 1, 10, lambda delay: P if delay <= 4 else "too large", lambda delay: None
    )
    assert (found.proved, found.refuted) == (4, None)
    assert "a longer one makes no loop (too large), no delay of up to 32 samples" in found.end


def test_what_is_known_is_not_decided_again_and_is_told_meanwhile():
    told = []

    def decide(delay: int) -> Verdict:
        assert delay != 1
        return P if delay <= 4 else R

    find_longest_delay(0, 1, 10, decide, lambda delay: None, P, told.append)
    assert told[:2] == ["delay 10 (proved: 1)", "delay 5 (proved: 1, refuted: 10)"]
    told.clear()
    find_longest_period(Fraction(1), lambda period: R, P, told.append)
    assert told[:2] == ["period 2 s (proved: 1 s)", "period 1.5 s (proved: 1 s, refuted: 2 s)"]


def test_the_longest_period():
    """Proved up to 3, refuted from 5 on; in between nobody knows."""

    def decide(period: Fraction) -> Verdict:
        return P if period <= 3 else R if period >= 5 else N

    found = find_longest_period(Fraction(1), decide)
    assert Fraction(29, 10) < found.proved <= 3
    assert 5 <= found.refuted < Fraction(51, 10) + Fraction(1, 4)
    below = find_longest_period(Fraction(8), decide)
    assert Fraction(5, 2) < below.proved <= 3
    assert 5 <= below.refuted < Fraction(55, 10)
    # From a period that is not decided, both sides are looked for.
    between = find_longest_period(Fraction(4), decide)
    assert Fraction(5, 2) < between.proved <= 3
    assert 5 <= between.refuted < Fraction(55, 10)


def test_where_no_period_is_refuted_the_end_is_named():
    found = find_longest_period(Fraction(1), lambda period: P if period == 1 else "too long")
    assert (found.proved, found.refuted) == (1, None)
    assert found.end == "none of up to 1 s is refuted: a longer one makes no loop (too long)"
    nothing = find_longest_period(Fraction(1), lambda period: N)
    assert nothing == Bracket(None, None, "none of up to 16 s is refuted: the search ends there")


def test_disturbances_that_keep_the_limit():
    """The limit is 1 N, the level 3/5 N, and a run reaches 1/2 N: by proportion."""
    system = pushed(bouncing())
    found = command_margin(BOUNCE.bound(system), 0.5)
    assert found.limit == 1
    kept, broken, unit = found.bounds["push"]
    assert (kept, broken, unit) == (Fraction(1, 4) * Fraction(5, 3), Fraction(1, 2), "N")
    assert command_margin(BOUNCE.bound(system), 0.0) is None


def test_what_is_refuted_in_kept_contact_alone_is_said_of_a_delay():
    found = find_longest_delay(0, 1, 2, lambda _: P, unstable_from(4, "in kept contact"))
    assert (found.proved, found.refuted, found.refuted_in) == (2, 4, "in kept contact")
    assert not find_longest_delay(0, 1, 2, lambda _: P, unstable_from(4)).refuted_in
