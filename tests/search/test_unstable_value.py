"""Search for values of a constant parameter at which something grows."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from nrs_design.proof.mode import Time
from nrs_design.search import unstable_value as mixture
from nrs_design.search.acceptance import OUT_OF_RANGE, Candidate, first_accepted
from nrs_design.search.family import Family
from nrs_design.search.unstable_value import (
    search_mixture,
    search_switching_at_values,
    search_value,
)
from nrs_design.search.work import Allowance
from tests.proof import systems
from tests.proof.truth import holds
from tests.search.support import found, outcome

TIMES = list(Time)


@pytest.mark.parametrize("time", TIMES)
def test_a_value_inside_the_range_is_found(time):
    """Both ends are stable; the worst share is one half, where the radius is c / 2."""
    system = systems.hidden_value("2.1", time)
    evidence, words = outcome(search_value, system)
    assert words == "found"
    assert evidence.shares == (Fraction(1, 2),)
    assert holds(system, evidence)


@pytest.mark.parametrize("time", TIMES)
def test_short_of_the_limit_nothing_is_claimed(time):
    evidence, words = outcome(search_value, systems.hidden_value("1.99", time))
    assert evidence is None
    assert words == "every mode is stable at every value tried"


def test_a_narrow_range_of_values_is_not_missed():
    """Unstable for shares within 0.005 of one half, far from every end."""
    system = systems.hidden_value(2 + Fraction(1, 10**4))
    assert outcome(search_value, system)[0].find_fault(system) is None


@pytest.mark.parametrize("time", TIMES)
def test_switching_at_one_value(time):
    """At every value all modes are stable, and at both ends switching is; in between it grows."""
    system = systems.hidden_shears(time)
    assert outcome(search_value, system)[0] is None
    evidence, _ = outcome(search_switching_at_values, system)
    assert evidence.shares == (Fraction(1, 2),)
    assert holds(system, evidence)


def test_switching_needs_two_modes_at_a_value():
    evidence, words = outcome(search_switching_at_values, systems.hidden_value("1.5"))
    assert evidence is None
    assert words.startswith("not tried: that takes two modes")


def test_modes_beyond_floating_point_are_left_alone():
    system = systems.family([[-1, 0], [0, -1]], [[-(10**400), 0], [0, -1]])
    broken = Family.of(system)
    assert not np.isfinite(broken.matrices).all()
    assert outcome(search_value, system) == (None, OUT_OF_RANGE)


def search(system):
    return found(search_mixture, system)


def test_two_shears_are_found():
    evidence = search(systems.shears())
    assert evidence.find_fault(systems.shears()) is None
    assert holds(systems.shears(), evidence)


@pytest.mark.parametrize(
    "system", [systems.branicky(), systems.dayawansa_martin(12), systems.family([[-1]])]
)
def test_unstable_switching_need_not_come_from_averages(system):
    assert search(system) is None


def test_three_modes_of_which_every_two_are_harmless():
    # Only the average of all three rotations of one shear expands.
    A = [[-1, 4, 0], [0, -1, 0], [0, 0, -1]]
    B = [[-1, 0, 0], [0, -1, 4], [0, 0, -1]]
    C = [[-1, 0, 0], [0, -1, 0], [4, 0, -1]]
    system = systems.family(A, B, C)
    assert search(systems.family(A, B)) is None
    evidence = search(system)
    assert len(evidence.steps) == 3
    assert evidence.find_fault(system) is None


@pytest.mark.parametrize("lie", [np.nan, np.inf, 1e300, -1e300])
def test_matrices_that_lie_give_no_verdict(lie):
    system = systems.dayawansa_martin(5)
    lying = replace(Family.of(system), matrices=np.full((2, 2, 2), lie))
    try:
        evidence, _ = first_accepted(search_mixture(lying), system)
    except np.linalg.LinAlgError:
        return
    assert evidence is None


@pytest.mark.parametrize("system", [systems.shears(), systems.branicky(), systems.family([[-1]])])
def test_chunks_change_nothing(monkeypatch, system):
    whole = search(system)
    monkeypatch.setattr(mixture, "CHUNK_ENTRIES", 20)
    assert search(system) == whole


def test_many_modes_are_looked_at_a_few_at_a_time(monkeypatch):
    """200 modes of 40 states made half a gigabyte of averages."""
    sizes = []
    for weights in mixture.weights_tried(200, 1000):
        sizes.append(len(weights))
        assert weights.sum(axis=1) == pytest.approx(1.0)
    assert max(sizes) == 1000
    assert sum(sizes) == mixture.MAX_PAIRS * (mixture.PAIR_SHARES - 1) + mixture.RANDOM_MIXTURES


def test_without_time_the_first_look_counts():
    family_ = Family.of(systems.shears(), Allowance(0.0))
    assert first_accepted(search_mixture(family_), systems.shears())[0] is not None


def test_ever_finer_shares_are_proposed():
    """One average, with ever finer shares."""
    proposed = list(search_mixture(Family.of(systems.shears())))
    assert all(isinstance(candidate, Candidate) for candidate in proposed)
    shares = [dict(candidate.evidence.steps)["m0"] for candidate in proposed]
    pairs = zip(shares, mixture.AVERAGE_DENOMINATORS, strict=True)
    assert all(share.denominator <= denominator for share, denominator in pairs)
