"""Whether a mode is stable, up to sizes at which deciding it would take minutes."""

from dataclasses import replace
from fractions import Fraction

import pytest

from nrs_design.proof.evidence.growing_sequence import staying
from nrs_design.proof.exact import MAX_SPECTRUM_WORK, TooLargeError, spectrum_work
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.spectrum import affordable, is_stable, worst_eigenvalue
from nrs_design.search.certify import certify
from tests.support import family
from tests.tables import by_rows


@by_rows("A", "time", "eigenvalue", time=Time)
def test_worst_eigenvalue(A, time, eigenvalue):
    (mode,) = family(A, time=time).modes
    assert worst_eigenvalue(mode.A, time) == eigenvalue


@pytest.mark.parametrize("time", Time)
@pytest.mark.parametrize(
    "A", [RationalMatrix(((16, 0), (0, -1))), RationalMatrix(((1, 0), (0, -1)), 16)]
)
def test_the_largest_numbers_that_are_decided(monkeypatch, time, A):
    limit, work = "nrs_design.proof.spectrum.MAX_SPECTRUM_WORK", spectrum_work(2, 5)
    system = replace(family([[0, 0], [0, 0]], time=time), modes=(Mode("m0", A),))
    monkeypatch.setattr(limit, work)
    is_unstable = not is_stable(A, time)
    assert (staying("m0").find_fault(system) is None) is is_unstable
    assert worst_eigenvalue(A, time)
    assert [fits for _, fits in affordable(system.modes)] == [True]
    monkeypatch.setattr(limit, work - 1)
    with pytest.raises(TooLargeError):
        is_stable(A, time)
    with pytest.raises(TooLargeError):
        worst_eigenvalue(A, time)
    assert "too large to check" in staying("m0").find_fault(system)
    assert [fits for _, fits in affordable(system.modes)] == [False]


def test_what_is_left_goes_to_smaller_modes(monkeypatch):
    limit = "nrs_design.proof.spectrum.MAX_SPECTRUM_WORK"
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
    assert "too large to check" in staying("m0").find_fault(system)
    certification = certify(system)
    assert str(certification.verdict) == "inconclusive"
    assert any("too large" in attempt.outcome for attempt in certification.attempts)


@pytest.mark.parametrize("time", Time)
@pytest.mark.parametrize("entry", ["-2", "-1/2", "1/2", "2"])
def test_one_state(entry, time):
    """Left of zero or within the unit circle: each answer differs between the two times."""
    wanted = entry.startswith("-") if time is Time.CONTINUOUS else "/" in entry
    assert is_stable(RationalMatrix.from_rows([[Fraction(entry)]]), time) is wanted
