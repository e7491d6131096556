"""Regions of sampled loops that saturate: against the same conditions written down anew."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from nrs_design.proof.mode import Time
from nrs_design.proof.saturation import CutOff, Saturation, Start
from nrs_design.search.candidates import NO_MARGIN
from nrs_design.search.certify import certify, first_accepted
from nrs_design.search.saturated_steps import search_saturated_steps
from nrs_design.work import Allowance, NotAffordableError
from tests.proof.systems import family, matrix, pushed_away_in_steps, saturating_in_steps

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
    return first_accepted(search_saturated_steps(system, Allowance()), system)


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


def test_where_the_wanted_start_is_out_of_reach_the_most_is_stated():
    largest, _ = found(planar())
    evidence, _ = found(planar(10 * largest.level))
    assert evidence.level == largest.level


def test_roundings_are_covered():
    evidence, _ = found(saturating_in_steps())
    assert evidence.covers_rounding
    # With h of what the signal is, v may be 5/3: here it goes beyond.
    assert evidence.level > 2


def test_a_loop_without_a_quadratic_function_has_no_region():
    signal = replace(pushed_away_in_steps().saturation.signals[0], rows=(matrix([["-1/4"]]),))
    what = replace(pushed_away_in_steps().saturation, signals=(signal,))
    system = replace(family([["5/4"]], time=Time.DISCRETE), saturation=what)
    assert found(system) == (None, NO_MARGIN)


def test_without_time_nothing_is_looked_for():
    with pytest.raises(NotAffordableError):
        next(search_saturated_steps(planar(), Allowance(0.0)))


def test_it_is_stated_beside_the_verdict():
    certification = certify(planar())
    assert [item.kind for item in certification.statements][-1] == "saturated-ellipsoid"
    assert certification.attempts[-1].step == "decay under saturation"
