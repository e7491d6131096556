"""Regions in which motions decay although signals saturate: published values, and bad input."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from nrs_design.proof.contact import Contact
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.saturation import CutOff, Saturation, Start
from nrs_design.search.acceptance import first_accepted
from nrs_design.search.certify import certify
from nrs_design.search.saturated_ellipsoid import search_saturated
from nrs_design.search.work import Allowance, NotAffordableError
from tests.proof.systems import (
    family,
    matrix,
    pushed_away,
    pushed_away_in_steps,
    saturating_in_steps,
)

KM, TAU, KD = Fraction("4.8417e-4"), Fraction("0.0351"), Fraction(2060)
KP, DRIVE, MT = KD * Fraction("56.9706"), KM / TAU, Fraction("0.01")
STIFFNESSES = Fraction("41.5"), Fraction("44.2")


def thesis(*dampings, lost=False, wanted=None):
    """The robot of the thesis by hand, in the states e, omega, vm and delta."""

    def rows(k, Bt):
        return [
            [0, -1, -1, 0],
            [DRIVE * KP, -1 / TAU - DRIVE * KD, -DRIVE * KD, 0],
            [0, 0, -Fraction(Bt) / MT, k / MT],
            [0, 1, 0, 0],
        ]

    system = family(*(rows(k, Bt) for Bt in dampings for k in STIFFNESSES))
    free = tuple(Mode(f"free {Bt}", matrix(rows(Fraction(0), Bt))) for Bt in dampings)
    count = len(system.modes) + lost * len(free)
    unit = [matrix([[int(i == j)] for j in range(4)]) for i in range(3)]
    signals = (
        CutOff(
            name="velocity command",
            unit="rad/s",
            limit=Fraction("0.13962634"),
            columns=(unit[0],) * count,
            rows=(matrix([[0, 0, -1, 0]]),) * count,
        ),
        CutOff(
            name="motor command",
            unit="rpm",
            limit=Fraction(2000),
            columns=(matrix([[0], [DRIVE], [0], [0]]),) * count,
            rows=(matrix([[KP, -KD, 0, 0, KD]]),) * count,
        ),
    )
    start = Start("force", "N*m", (matrix([[0], [0], [0], [Fraction(1, 43)]]),), wanted)
    contact = Contact(free, required=True) if lost else None
    return replace(system, contact=contact, saturation=Saturation(signals, start))


A, B = [["4/5", "1/2"], ["-2/5", "6/5"]], [[0], [1]]
F = [["-1/5", "-3/5"]]


def planar(wanted=None, limit=Fraction(7)):
    """x+ = A x + B sat(F x), unstable without the signal."""
    closed = [[Fraction(a) + Fraction(b[0]) * Fraction(f) for a, f in zip(row, F[0], strict=True)]
              for row, b in zip(A, B, strict=True)]  # fmt: skip
    signal = CutOff(name="u", unit="N", limit=limit, columns=(matrix(B),), rows=(matrix(F),))
    start = Start("place", "m", (matrix([[1], [0]]), matrix([[0], [1]])), wanted)
    system = family(closed, time=Time.DISCRETE)
    return replace(system, saturation=Saturation((signal,), start), sample_time=Fraction(1, 100))


def found(system):
    return first_accepted(search_saturated(system, Allowance()), system)


@pytest.mark.parametrize("lost", [False, True])
@pytest.mark.parametrize(
    ("dampings", "force"), [(("2.15",), 2.45), (("1.04",), 0.895), (("2.15", "1.04"), 0.887)]
)
def test_the_reference_is_reached(dampings, force, lost):
    """0.89 N m and 2.45 N m at 43 N m/rad in the reference, with contact kept."""
    evidence, words = found(thesis(*dampings, lost=lost))
    assert words == "found"
    assert float(evidence.level) == pytest.approx(0.99 * force, rel=2e-3)


@pytest.mark.slow
def test_a_wanted_force_decays_as_fast_as_is_found():
    evidence, _ = found(thesis("2.15", "1.04", lost=True, wanted=Fraction(1, 2)))
    assert evidence.level == Fraction(1, 2)
    assert evidence.rate > 2.5
    larger, _ = found(thesis("2.15", "1.04", lost=True, wanted=Fraction(4, 5)))
    assert larger.level == Fraction(4, 5)
    assert 0.1 < larger.rate < 1.5


def test_where_the_wanted_force_is_out_of_reach_the_most_is_stated():
    evidence, _ = found(thesis("2.15", wanted=Fraction(3)))
    assert 2.4 < evidence.level < 2.45


def test_a_region_that_is_known_is_nearly_filled():
    evidence, _ = found(pushed_away())
    assert 0.98 < evidence.level < 1


def test_the_region_is_the_largest_of_hu_and_lin():
    """Hu, Lin and Chen 2002: max s with s x x' <= S, [[S, (A S + B Y)'], [., S]] > 0 and so on."""
    import cvxpy as cp

    numbers = [np.array([[float(Fraction(v)) for v in row] for row in M]) for M in (A, B, F)]
    a, b, f = numbers
    S, Y, s = cp.Variable((2, 2), symmetric=True), cp.Variable((1, 2)), cp.Variable()
    wanted = [cp.bmat([[S, Y.T], [Y, np.array([[49.0]])]]) >> 0]
    wanted += [S - s * np.outer(x, x) >> 0 for x in np.eye(2)]
    for image in (a @ S + b @ (f @ S), a @ S + b @ Y):
        wanted.append(cp.bmat([[S, image.T], [image, S]]) >> 0)
    cp.Problem(cp.Maximize(s), wanted).solve(solver=cp.CLARABEL)
    evidence, words = found(planar())
    assert words == "found"
    assert 0.93 * np.sqrt(s.value) < evidence.level < np.sqrt(s.value)


def test_a_region_grows_with_the_limit():
    small, large = (found(planar(limit=Fraction(limit)))[0].level for limit in (1, 10))
    assert float(large / small) == pytest.approx(10, rel=1e-2)


def test_a_smaller_start_decays_faster():
    largest, _ = found(planar())
    wanted = Fraction(round(largest.level / 2))
    evidence, _ = found(planar(wanted))
    assert evidence.level == wanted
    assert evidence.rate < largest.rate


def test_where_a_wanted_start_is_out_of_reach_the_most_is_stated():
    largest, _ = found(planar())
    evidence, _ = found(planar(10 * largest.level))
    assert evidence.level == largest.level


def test_roundings_are_covered():
    evidence, _ = found(saturating_in_steps())
    assert evidence.covers_rounding
    # With h of what the signal is, v may be 5/3: here it goes beyond.
    assert evidence.level > 2


def unstable_in_steps():
    signal = replace(pushed_away_in_steps().saturation.signals[0], rows=(matrix([["-1/4"]]),))
    what = replace(pushed_away_in_steps().saturation, signals=(signal,))
    return replace(family([["5/4"]], time=Time.DISCRETE), saturation=what)


@pytest.mark.parametrize("system", [pushed_away("1/2"), unstable_in_steps()])
def test_a_loop_without_a_quadratic_function_has_no_region(system):
    with pytest.raises(np.linalg.LinAlgError, match=r"a mode that is not stable|Singular"):
        found(system)


@pytest.mark.parametrize("system", [pushed_away(), planar()])
def test_without_time_nothing_is_looked_for(system):
    with pytest.raises(NotAffordableError):
        next(search_saturated(system, Allowance(0.0)))


@pytest.mark.parametrize("system", [thesis("2.15"), planar()])
def test_it_is_stated_beside_the_verdict(system):
    certification = certify(system)
    assert [item.kind for item in certification.statements][-1] == "saturated-ellipsoid"
    assert certification.evidence.kind != "saturated-ellipsoid"
    assert certification.attempts[-1].step == "decay under saturation"
    # Equal modes are merged for the verdict, and each has what it does to its signals.
    twice = replace(
        system,
        modes=(*system.modes, *(replace(mode, name=f"{mode.name}'") for mode in system.modes)),
        saturation=replace(
            system.saturation,
            signals=tuple(
                replace(s, columns=s.columns * 2, rows=s.rows * 2)
                for s in system.saturation.signals
            ),
        ),
    )
    assert certify(twice).statements[-1].find_fault(twice) is None
