"""One mode that is not stable: decided exactly, on the border too."""

from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nrs_design.proof.evidence import Shows, UnstableMode
from nrs_design.proof.evidence.unstable_mode import (
    affordable,
    is_stable,
    worst_eigenvalue,
)
from nrs_design.proof.exact import MAX_SPECTRUM_WORK, TooLargeError, spectrum_work
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.switching import Reset, Stay, Switching
from nrs_design.search.certify import certify
from tests.support import dayawansa_martin, family, holds, is_stable_by_lyapunov, matrix


@pytest.mark.parametrize(
    ("A", "time", "stable"),
    [
        ([["-0.36", "-0.48"], ["-0.48", "-0.64"]], Time.CONTINUOUS, False),
        ([[0, 1], [-1, 0]], Time.CONTINUOUS, False),
        ([[-1, 0], [0, -1]], Time.CONTINUOUS, True),
        ([[-1, 0], [0, -1]], Time.DISCRETE, False),
        ([["-1/2", 0], [0, "1/2"]], Time.DISCRETE, True),
        ([["-1/2", 0], [0, "1/2"]], Time.CONTINUOUS, False),
        ([["0.6", "0.8"], ["-0.8", "0.6"]], Time.DISCRETE, False),
    ],
)
def test_unstable_mode(A, time, stable):
    system = family([[0, 0], [0, 0]], A, time=time)
    assert is_stable(system.modes[1].A, time) is stable
    found = UnstableMode("m1", "never looked at").find_fault(system)
    assert (found is None) is not stable


def test_unknown_and_ambiguous_modes_refute_nothing():
    system = family([[1, 0], [0, 1]])
    assert UnstableMode("m0", "1").find_fault(system) is None
    assert "no single mode" in UnstableMode("m1", "1").find_fault(system)
    twice = replace(system, modes=system.modes * 2)
    assert "same name" in UnstableMode("m0", "1").find_fault(twice)
    assert "no single mode" in UnstableMode("m0", "1").find_misfit(twice)


@pytest.mark.parametrize(
    ("A", "time", "eigenvalue"),
    [
        ([[0, 1], [-1, 0]], Time.CONTINUOUS, "0 +- 1j"),
        ([["-0.36", "-0.48"], ["-0.48", "-0.64"]], Time.CONTINUOUS, "0"),
        ([[1, 0], [0, -5]], Time.CONTINUOUS, "1"),
        ([["1/2", 0], [0, -3]], Time.DISCRETE, "-3"),
        ([["0.6", "0.8"], ["-0.8", "0.6"]], Time.DISCRETE, "0.6 +- 0.8j"),
    ],
)
def test_worst_eigenvalue(A, time, eigenvalue):
    (mode,) = family(A, time=time).modes
    assert worst_eigenvalue(mode.A, time) == eigenvalue


@settings(deadline=None)
@given(st.lists(st.integers(-6, 6), min_size=9, max_size=9), st.sampled_from(list(Time)))
def test_against_the_lyapunov_equation(entries, time):
    """Another algorithm, without a characteristic polynomial."""
    rows = [[Fraction(e, 5) for e in entries[i : i + 3]] for i in (0, 3, 6)]
    system = family(rows, time=time)
    stable = is_stable_by_lyapunov(rows, discrete=time is Time.DISCRETE)
    assert is_stable(system.modes[0].A, time) is stable
    evidence = UnstableMode("m0", "")
    assert (evidence.find_fault(system) is None) is not stable
    assert holds(system, evidence) is not stable


def test_stable_modes_give_no_evidence():
    found = certify(dayawansa_martin(5))
    assert not any(isinstance(statement, UnstableMode) for statement in found.statements)


@pytest.mark.parametrize(
    "switching",
    [
        Switching(dwell_time=Fraction(10**6)),
        Switching(transitions=()),
        Switching(resets=(Reset("m0", "m1", matrix([[0, 0], [0, 0]])),)),
        Switching(fixed_ends=(("m0", "m1"),)),
    ],
)
def test_no_rule_of_switching_forces_a_signal_to_leave_its_mode(switching):
    system = family([[1, 0], [0, 1]], [[-1, 0], [0, -1]])
    assert UnstableMode("m0", "1").find_fault(replace(system, switching=switching)) is None
    assert "stable" in UnstableMode("m1", "1").find_fault(replace(system, switching=switching))


def test_words_and_fields():
    evidence, system = UnstableMode("m0", "2"), family([[2]])
    assert evidence.shows is Shows.INSTABILITY
    assert evidence.proved_rate(system) is None
    assert evidence.claim(system) == (
        "Mode m0 is not Hurwitz (eigenvalue about 2): staying in it is an admissible switching "
        "signal, so x' = A x is not uniformly exponentially stable."
    )
    assert evidence.to_fields() == {"mode": "m0", "eigenvalue": "2"}
    # The eigenvalue of a file is not believed but computed again.
    assert UnstableMode.from_fields({"mode": "m0", "eigenvalue": "7"}, system) == evidence


@pytest.mark.parametrize("fields", [{}, {"mode": None}, {"mode": "m7"}, {"mode": 0}])
def test_malformed_fields(fields):
    with pytest.raises((KeyError, TypeError, ValueError)):
        UnstableMode.from_fields(fields, family([[2]]))


def test_a_mode_that_must_be_left_refutes_nothing():
    stays = (("m0", Stay(Fraction(1), Fraction(3))),)
    system = family([[2]], [["1/8"]], time=Time.DISCRETE)
    system = replace(system, switching=Switching(stays=stays))
    evidence = UnstableMode("m0", "2")
    assert evidence.find_fault(replace(system, switching=Switching(Fraction(3)))) is None
    assert "does not cover this kind of switching" in evidence.find_fault(system)
    assert not holds(system, evidence)


def long_mode(n: int, bits: int) -> list[list[int]]:
    """Return a dense matrix with entries of so many bits, none of them structured."""
    return [
        [(-1) ** (i * j) * (2**bits - 1) // (i + 2 * j + 1) for j in range(n)] for i in range(n)
    ]


@pytest.mark.parametrize("time", Time)
def test_what_would_take_minutes_is_not_decided(time):
    system = family(long_mode(30, 40_000), time=time)
    with pytest.raises(TooLargeError, match="too large"):
        is_stable(system.modes[0].A, time)
    with pytest.raises(TooLargeError, match="too large"):
        worst_eigenvalue(system.modes[0].A, time)
    assert "too large to check" in UnstableMode("m0", "1").find_fault(system)
    certification = certify(system)
    assert str(certification.verdict) == "inconclusive"
    assert any("too large" in attempt.outcome for attempt in certification.attempts)


@pytest.mark.parametrize("time", Time)
@pytest.mark.parametrize(
    "A", [RationalMatrix(((16, 0), (0, -1))), RationalMatrix(((1, 0), (0, -1)), 16)]
)
def test_the_largest_numbers_that_are_decided(monkeypatch, time, A):
    limit, work = "nrs_design.proof.evidence.unstable_mode.MAX_SPECTRUM_WORK", spectrum_work(2, 5)
    system = replace(family([[0, 0], [0, 0]], time=time), modes=(Mode("m0", A),))
    monkeypatch.setattr(limit, work)
    is_unstable = not is_stable(A, time)
    assert (UnstableMode("m0", "").find_fault(system) is None) is is_unstable
    assert worst_eigenvalue(A, time)
    assert [fits for _, fits in affordable(system.modes)] == [True]
    monkeypatch.setattr(limit, work - 1)
    with pytest.raises(TooLargeError):
        is_stable(A, time)
    with pytest.raises(TooLargeError):
        worst_eigenvalue(A, time)
    assert "too large to check" in UnstableMode("m0", "").find_fault(system)
    assert [fits for _, fits in affordable(system.modes)] == [False]


def test_what_is_left_goes_to_smaller_modes(monkeypatch):
    limit = "nrs_design.proof.evidence.unstable_mode.MAX_SPECTRUM_WORK"
    large, small = spectrum_work(2, 5), spectrum_work(2, 1)
    modes = [Mode(f"m{k}", RationalMatrix(((a, 0), (0, 1)))) for k, a in enumerate((16, 16, 1, 1))]
    monkeypatch.setattr(limit, large + small)
    assert [fits for _, fits in affordable(modes)] == [True, False, True, False]
    assert [mode for mode, _ in affordable(modes)] == modes


def test_many_modes_share_what_is_affordable():
    system = family(*[long_mode(16, 1000)] * 4)
    decided = [fits for _, fits in affordable(system.modes)]
    assert decided == sorted(decided, reverse=True)
    assert decided[0]
    assert not decided[-1]
    work = spectrum_work(16, 1000)
    assert sum(decided) == MAX_SPECTRUM_WORK // work


def test_the_predicted_work_is_that_of_long_numbers():
    # Twice the rows of long numbers: n^5 times the work; of short ones n^4.
    assert 31 < spectrum_work(32, 10**6) / spectrum_work(16, 10**6) < 33
    assert 16 <= spectrum_work(32, 4) / spectrum_work(16, 4) < 20
