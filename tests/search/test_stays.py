"""Predictions of how finely stays are to be cut are what the exact check needs."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from scipy.linalg import expm

from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.switching import Reset, Stay, Switching
from nrs_design.search.certify import certify
from nrs_design.search.stays import PIECES, enough_pieces, round_stays
from tests.proof.systems import family

A = [["0.13", "1.22"], ["-1.13", "-0.56"]]
B = [["-0.77", "-1.5"], ["0.96", "1.31"]]


def timed(widths, matrices=(A, B), stays=("1.7", "1.1"), resets=()):
    """Two modes in turn, each with a stay of a length that is known but for a share of it."""
    each = tuple(
        (name, Stay(Fraction(stay), Fraction(stay) * (1 + Fraction(width))))
        for name, stay, width in zip("ab", stays, widths, strict=True)
    )
    return family(*matrices, names="ab", switching=Switching(resets=resets, stays=each))


SMALLER = (Reset("a", "b", RationalMatrix(((9, 1), (0, 8)), 10)),)


@pytest.mark.parametrize(("widths", "resets"), [(("0.06", "0.03"), ()), (("0.2", "0.1"), SMALLER)])
def test_as_many_as_the_check_needs(widths, resets):
    system = timed(widths, resets=resets)
    found = certify(system).evidence
    enough = found.stays.pieces
    assert enough == enough_pieces(system, found) > 4
    coarse = replace(found, stays=replace(found.stays, pieces=enough // 4))
    assert found.find_fault(system) is None
    assert "does not decrease" in (coarse.find_fault(system) or "")


def test_one_for_stays_of_one_length():
    system = timed((0, 0))
    found = certify(system).evidence
    assert enough_pieces(system, found) == 1


def test_none_where_forms_do_not_decrease():
    system = timed(("0.02", "0.01"))
    found = certify(system).evidence
    assert enough_pieces(system, replace(found, rate=Fraction(2))) is None
    assert np.all(np.diff(PIECES) > 0)


# From a random search: without coordinates of their own, the solver or the rounding fails.
LONG = [[["-4.11", "7.26"], ["-2.15", "4.73"]], [["1.3", "-4.1"], ["2.2", "-5.3"]]]
SLOW = [
    [["-0.5", "2", "0"], ["-2", "-0.5", "1"], ["0", "0", "-0.8"]],
    [["0.2", "0", "1"], ["0", "-0.3", "0"], ["-1", "0.5", "-0.9"]],
]


@pytest.mark.parametrize("matrices", [LONG, SLOW])
def test_a_stay_in_one_mode_and_then_the_other_contracts(matrices):
    system = timed((0, 0), matrices)
    found = {name: one.whole for name, one in round_stays(system, ("a", "b")).items()}
    A, B = (np.array(rows, dtype=float) for rows in matrices)
    period = expm(B * 1.1) @ expm(A * 1.7)
    radius = np.abs(np.linalg.eigvals(period)).max()
    inside = np.linalg.inv(found["a"]) @ period @ found["a"]
    assert np.linalg.norm(inside, 2) < max(1.0, 1.2 * radius)


def test_modes_that_may_stay_have_coordinates_as_well():
    system = timed((0, 0), [[["-1", "5"], ["0", "-2"]], [["-2", "0"], ["4", "-1"]]])
    found = round_stays(system, ("a",))
    assert all(np.linalg.cond(one.whole) < 100 for one in found.values())
