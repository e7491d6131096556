"""Search for unstable averages."""

from dataclasses import replace

import numpy as np
import pytest

from nrs_design.search import unstable_value as mixture
from nrs_design.search.acceptance import Candidate, first_accepted
from nrs_design.search.family import Family
from nrs_design.search.unstable_value import search_mixture
from nrs_design.work import Allowance
from tests.proof.systems import branicky, dayawansa_martin, family, shears
from tests.proof.truth import holds
from tests.search.support import found


def search(system):
    return found(search_mixture, system)


def test_two_shears_are_found():
    evidence = search(shears())
    assert evidence.find_fault(shears()) is None
    assert holds(shears(), evidence)


@pytest.mark.parametrize("system", [branicky(), dayawansa_martin(12), family([[-1]])])
def test_unstable_switching_need_not_come_from_averages(system):
    assert search(system) is None


def test_three_modes_of_which_every_two_are_harmless():
    # Only the average of all three rotations of one shear expands.
    A = [[-1, 4, 0], [0, -1, 0], [0, 0, -1]]
    B = [[-1, 0, 0], [0, -1, 4], [0, 0, -1]]
    C = [[-1, 0, 0], [0, -1, 0], [4, 0, -1]]
    system = family(A, B, C)
    assert search(family(A, B)) is None
    evidence = search(system)
    assert len(evidence.steps) == 3
    assert evidence.find_fault(system) is None


@pytest.mark.parametrize("lie", [np.nan, np.inf, 1e300, -1e300])
def test_matrices_that_lie_give_no_verdict(lie):
    system = dayawansa_martin(5)
    lying = replace(Family.of(system), matrices=np.full((2, 2, 2), lie))
    try:
        evidence, _ = first_accepted(search_mixture(lying), system)
    except np.linalg.LinAlgError:
        return
    assert evidence is None


@pytest.mark.parametrize("system", [shears(), branicky(), family([[-1]])])
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
    family_ = Family.of(shears(), Allowance(0.0))
    assert first_accepted(search_mixture(family_), shears())[0] is not None


def test_ever_finer_shares_are_proposed():
    """One average, with ever finer shares."""
    proposed = list(search_mixture(Family.of(shears())))
    assert all(isinstance(candidate, Candidate) for candidate in proposed)
    shares = [dict(candidate.evidence.steps)["m0"] for candidate in proposed]
    pairs = zip(shares, mixture.AVERAGE_DENOMINATORS, strict=True)
    assert all(share.denominator <= denominator for share, denominator in pairs)
