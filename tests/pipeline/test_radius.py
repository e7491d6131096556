"""Both ends of the largest growth per step, against published and exact values."""

from fractions import Fraction

import numpy as np
import pytest

from nrs_design.pipeline.radius import bound_radius
from nrs_design.proof.switching import Stay, Switching
from nrs_design.search.certification import Limits
from nrs_design.search.certify import certify
from nrs_design.search.method import Method
from tests.proof.systems import family, golden, lossy_network
from tests.search.test_branches import random_system

GOLDEN = (1 + 5**0.5) / 2


def bounds(system, method=Method.AUTO):
    found = certify(system, method)
    return found, bound_radius(found, Limits())


def test_a_family_that_grows_by_the_golden_ratio():
    found, radius = bounds(golden(1))
    assert found.verdict == "refuted"
    assert GOLDEN * (1 - 1e-6) < radius.lower < GOLDEN < radius.upper < GOLDEN * 1.002


@pytest.mark.parametrize("scale", ["1", "1.026"])
def test_the_lossy_network(scale):
    """Philippe et al. 2016: 0.97482; 0.98635 by degree 4; proved as it is, and refuted."""
    found, radius = bounds(lossy_network(Fraction(scale)))
    assert found.verdict == ("proved" if scale == "1" else "refuted")
    lower, upper = (float(end) / float(scale) for end in (radius.lower, radius.upper))
    assert lower == pytest.approx(0.9748172, abs=2e-6)
    assert lower < 0.9748171979372074
    assert 0.9748172 < upper < 0.9751
    assert "with a memory of" in radius.method


def test_where_nothing_is_decided():
    """One rung alone does not decide it: the ends are there all the same."""
    found, radius = bounds(lossy_network(Fraction("1.02")), Method.MODE_QUADRATIC)
    assert found.verdict == "inconclusive"
    assert 0.99431 < radius.lower < 0.994314 < radius.upper < 1.007


def test_the_word_is_shown_for_the_divided_modes():
    system = lossy_network()
    _, radius = bounds(system)
    product = np.eye(2)
    for name, count in radius.word:
        A = next(np.array(mode.A.floats()) for mode in system.modes if mode.name == name)
        product = np.linalg.matrix_power(A, int(count)) @ product
    length = sum(int(count) for _, count in radius.word)
    assert float(radius.lower) < np.abs(np.linalg.eigvals(product)).max() ** (1 / length)
    assert radius.evidence.fits(system.switching)


@pytest.mark.parametrize("seed", range(8))
def test_the_ends_are_never_the_wrong_way_round(seed):
    _, radius = bounds(random_system(seed))
    assert 0 < radius.lower <= radius.upper


def test_what_decays_at_once_and_what_never_repeats():
    nothing = family([[0, 1], [0, 0]], [[0, 2], [0, 0]], time="discrete")
    assert bounds(nothing)[1].lower is None
    once = Switching(transitions=(("m0", "m1"),), stays=(("m0", Stay(1, 1)),))
    _, radius = bounds(family([["3"]], [["1/2"]], time="discrete", switching=once))
    assert radius.lower < Fraction(1, 2) < radius.upper < 1


def test_none_in_continuous_time():
    assert bounds(family([[-1, 0], [0, -2]], [[-3, 1], [0, -1]]))[1] is None
