"""Branch and bound finds the words that grow most: published ones, and those of brute force."""

from itertools import product

import numpy as np
import pytest

from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Stay, Switching
from nrs_design.search.branches import StepGraph, best_words
from nrs_design.work import Allowance
from tests.proof.systems import family, golden, lossy_network


def best(system, **given):
    graph = StepGraph.of(system, np.array([mode.A.floats() for mode in system.modes]))
    *_, last = best_words(graph, given.pop("allowance", Allowance()), **given)
    return graph, *last


def test_the_lossy_network():
    """Philippe et al. 2016: 0.9748171979372074, by a word of eight steps."""
    _, word, growth = best(lossy_network())
    assert growth == pytest.approx(0.9748171979372074, abs=1e-12)
    assert len(word) == 8


def test_the_golden_ratio():
    assert best(golden(1))[2] == pytest.approx((1 + 5**0.5) / 2)


def random_system(seed):
    rng = np.random.default_rng(seed)
    modes = rng.integers(-9, 10, (2, 2, 2))
    rows = [[[f"{v}/10" for v in row] for row in A.tolist()] for A in modes]
    rules = [
        Switching(),
        Switching(dwell_time=2),
        Switching(stays=(("m0", Stay(1, 2)),)),
        Switching(stays=(("m1", Stay(2, 3)), ("m0", Stay(1, 1)))),
    ]
    return family(*rows, time=Time.DISCRETE, switching=rules[seed % 4])


@pytest.mark.parametrize("seed", range(16))
def test_no_short_word_grows_more(seed):
    system = random_system(seed)
    graph, word, growth = best(system)
    product_of = np.eye(2)
    for edge in word:
        product_of = graph.maps[edge] @ product_of
    radius = np.abs(np.linalg.eigvals(product_of)).max()
    assert growth == pytest.approx(radius ** (1 / len(word)))
    for length in range(1, 7):
        for edges in product(range(len(graph.sources)), repeat=length):
            ends = [*graph.sources[[*edges[1:], edges[0]]]]
            if [*graph.targets[[*edges]]] != ends:
                continue
            M = np.eye(2)
            for edge in edges:
                M = graph.maps[edge] @ M
            assert np.abs(np.linalg.eigvals(M)).max() ** (1 / length) <= growth * (1 + 1e-5)


def test_nothing_above_the_floor():
    graph = StepGraph.of(golden(1), np.array([mode.A.floats() for mode in golden(1).modes]))
    assert list(best_words(graph, Allowance(), 1.7)) == []


def test_work_that_does_not_suffice_ends_it():
    assert len(best(golden(1), allowance=Allowance(1e-3))[1]) <= 2
