"""Branch and bound finds the words that grow most: published ones, and those of brute force."""

from fractions import Fraction
from itertools import pairwise, product

import numpy as np
import pytest

from nrs_design.proof.evidence import GrowingSequence
from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Stay, Switching
from nrs_design.search.branches import StepGraph, best_words
from nrs_design.search.work import Allowance
from tests.proof.systems import family, golden, lossy_network, resets_between


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


MODES = [["1/2"]], [["1/3"]], [["1/5"]]


def drawn(switching, *modes):
    system = family(*(modes or MODES), time=Time.DISCRETE, switching=switching)
    return system, StepGraph.of(system, np.array([mode.A.floats() for mode in system.modes]))


def stays(**each):
    return tuple((name, Stay(Fraction(a), b and Fraction(b))) for name, (a, b) in each.items())


RULES = [
    Switching(),
    Switching(Fraction(2)),
    Switching(transitions=(("m0", "m1"), ("m1", "m2"), ("m2", "m0"), ("m1", "m0"))),
    Switching(stays=stays(m0=(2, 3), m1=(1, 1), m2=(2, None))),
    Switching(Fraction(1), stays=stays(m1=(3, 3)), transitions=(("m0", "m1"), ("m1", "m0"))),
]


@pytest.mark.parametrize("rules", RULES)
def test_closed_words_are_periodic_signals(rules):
    """Whatever closes fits the rules as evidence does; and by count it is every such signal."""
    system, graph = drawn(rules)
    length, closed = 6, 0
    after = {}
    for edge, source in enumerate(graph.sources):
        after.setdefault(int(source), []).append(edge)
    words = [(edge,) for edge in range(len(graph.sources))]
    for _ in range(length - 1):
        words = [(*w, e) for w in words for e in after[int(graph.targets[w[-1]])]]
    found = set()
    for word in words:
        if graph.targets[word[-1]] != graph.sources[word[0]]:
            continue
        closed += 1
        names, ways = graph.sequence(word)
        assert GrowingSequence(names, 1, ways).fits(system.switching)
        found.add(tuple(int(graph.modes[edge]) for edge in word))
    expected = {word for word in product(range(3), repeat=length) if keeps(word * 3, system, rules)}
    assert found == expected
    assert closed


def keeps(word, system, rules):
    """Tell whether a word that goes on for ever keeps the rules, by the definition."""
    runs, begin = [], 0
    for k in range(1, len(word) + 1):
        if k == len(word) or word[k] != word[begin]:
            runs.append((word[begin], k - begin))
            begin = k
    names = [f"m{mode}" for mode, _ in runs]
    allowed = rules.transitions
    if allowed is not None and not set(pairwise(names)) <= set(allowed):
        return False
    if len(runs) == 1:
        return system.stays()[names[0]].longest is None
    # The first and the last run go on outside.
    return all(
        system.stays()[f"m{mode}"].shortest <= count
        and (system.stays()[f"m{mode}"].longest or count) >= count
        for mode, count in runs[1:-1]
    )


def test_the_product_of_a_word_is_that_of_its_signal():
    resets = resets_between(("m0", "m1", [[3]]), ("m0", "m1", [[5]]), ("m1", "m0", [[7]]))
    rules = Switching(transitions=(("m0", "m1"), ("m1", "m0")), resets=resets)
    _, graph = drawn(rules, *MODES[:2])
    found = set()
    for a, b in product(range(len(graph.sources)), repeat=2):
        if graph.targets[a] == graph.sources[b] and graph.targets[b] == graph.sources[a]:
            names = graph.sequence((a, b))
            if len(names[0]) == 2:
                value = float((graph.maps[b] @ graph.maps[a])[0, 0])
                found.add((names, round(value, 9)))
    steps = (("m0", 1), ("m1", 1))
    assert ((steps, (0, 0)), round(3 * 7 / 6, 9)) in found
    assert ((steps, (1, 0)), round(5 * 7 / 6, 9)) in found


def test_none_where_there_is_none():
    modes = [["-1"]], [["-2"]]
    assert StepGraph.of(family(*modes), -np.ones((2, 1, 1))) is None
    _, long = drawn(Switching(Fraction(4000)))
    assert long is None
    assert StepGraph.of(golden(1), np.ones((2, 2, 2))).count == 1
