"""Forms that remember the last steps: words, graphs, and what the check says of them."""

from dataclasses import replace
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest

from nrs_design.proof.evidence.graph import MAX_SETS, Arc
from nrs_design.proof.switching import Stay, Switching
from nrs_design.search import memory
from nrs_design.search.acceptance import first_accepted
from nrs_design.search.certify import Limits, certify
from nrs_design.search.family import Family
from nrs_design.search.forms import FormsProgram
from nrs_design.search.method import Method
from nrs_design.search.work import Allowance
from tests.literature.test_growth_per_step import divided
from tests.proof.systems import ando_shih, family, golden, lossy_network

# Philippe et al. 2016, with a memory of two steps (2-dependent lift): degree 2 and 4, by
# SwitchOnSafety.jl, test/PEDJ16s4.jl.
LIFTED = {2: 0.9820958128927598, 4: 0.9753566329765574}


def test_words_without_rules_are_all():
    system = ando_shih(1)
    assert memory.following(system) == {"m0": ["m0", "m1"], "m1": ["m0", "m1"]}
    assert memory.words(system, 2) == [("m0", "m0"), ("m0", "m1"), ("m1", "m0"), ("m1", "m1")]
    assert memory.count_words(system, 3) == (8, 16)


def test_words_under_rules_are_those_that_the_rules_allow():
    rules = Switching(transitions=(("m0", "m1"), ("m1", "m0")), stays=(("m1", Stay(1, 1)),))
    system = family([["1/2"]], [["3/2"]], time="discrete", switching=rules)
    assert memory.following(system) == {"m0": ["m0", "m1"], "m1": ["m0"]}
    found = memory.words(system, 3)
    assert len(found) == 5
    assert not any(pair == ("m1", "m1") for word in found for pair in pairwise(word))


def test_what_never_ends_in_a_word_has_none():
    rules = Switching(transitions=(), stays=(("m0", Stay(1, 1)), ("m1", Stay(1, 1))))
    system = family([["1/2"]], [["1/2"]], time="discrete", switching=rules)
    assert memory.words(system, 2) is None


def test_memories_end_where_the_check_would_refuse_them():
    longest = max(memory.memories(ando_shih(1)))
    assert 2**longest <= memory.MOST_WORDS < 2 ** (longest + 1) <= MAX_SETS
    assert min(memory.quadratic_memories(lossy_network())) == 2
    assert not memory.quartic_memories(family([[1]], [[2]], time="discrete"))


@pytest.mark.parametrize("degree", LIFTED)
def test_a_memory_of_two_steps_shows_no_less_than_is_published(degree):
    """Quadratic forms for the nodes alone show nothing: 1.00358."""
    system = lossy_network()
    family_of = Family.of(system, Allowance(20.0))
    evidence, _ = first_accepted(memory.search_memory(family_of, 2, degree // 2), system)
    assert 0.9748171979 < evidence.rate < LIFTED[degree] * 1.001


@pytest.fixture(scope="module", params=["rules", "none"])
def proved(request):
    """A genuine graph of words, with what is beyond it."""
    ruled = request.param == "rules"
    system = lossy_network() if ruled else ando_shih("0.99")
    found = certify(system, Method.MEMORY_QUADRATIC, Limits(optimize_rate=False))
    assert found.verdict == "proved"
    return system, found.evidence, lossy_network(Fraction("1.03")) if ruled else ando_shih("1.01")


class TestWhatTheCheckSays:
    """Of a genuine graph of words, with and without rules."""

    def test_it_holds_up_to_a_constant_factor(self, proved):
        system, evidence, _ = proved
        assert evidence.find_fault(system) is None
        assert len(evidence.nodes) > len(system.modes) - 1
        assert "some constant c" in evidence.claim(system)
        assert not evidence.covers_mixtures

    def test_a_word_without_its_edge_is_missed(self, proved):
        system, evidence, _ = proved
        for k in range(len(evidence.edges)):
            left = replace(evidence, edges=evidence.edges[:k] + evidence.edges[k + 1 :])
            assert "the graph has no edge" in left.find_fault(system)

    def test_forms_of_other_words_do_not_hold(self, proved):
        system, evidence, _ = proved
        first, *rest = evidence.nodes
        one = next(k for k, node in enumerate(rest) if node.form != first.form)
        swapped = list(evidence.nodes)
        swapped[0] = first._replace(form=rest[one].form)
        swapped[one + 1] = rest[one]._replace(form=first.form)
        assert replace(evidence, nodes=tuple(swapped)).find_fault(system) is not None

    def test_every_edge_at_once_asks_for_too_much(self, proved):
        system, evidence, _ = proved
        assert replace(evidence, edges=(Arc(),)).find_fault(system) is not None

    def test_a_system_that_grows_is_not_proved(self, proved):
        _, evidence, grows = proved
        assert "V does not decrease" in evidence.find_fault(grows)


def test_equal_modes_keep_their_words():
    """Of modes that are equal, one is searched for; the others carry its edges."""
    A, B = [["99/100", 0], ["99/100", 0]], [[0, "99/100"], [0, "-99/100"]]
    system = family(A, B, A, time="discrete")
    for method in (Method.MEMORY_QUADRATIC, Method.MEMORY_POLYNOMIAL):
        found = certify(system, method, Limits(optimize_rate=False))
        assert found.verdict == "proved"
        assert found.evidence.find_fault(system) is None


def test_a_drawing_has_a_node_for_each_word_and_an_edge_for_each_longer_one():
    drawing = memory.draw_memory(lossy_network(Fraction(1, 2)), 2)
    nodes, edges = memory.count_words(lossy_network(), 2)
    assert (len(drawing.graph.nodes), len(drawing.graph.edges)) == (nodes, edges)


LONG = 1.6841852824915513


def sought(system):
    return first_accepted(memory.search_extremal_words(Family.of(system, Allowance(20.0))), system)[
        0
    ]


def test_a_long_word_is_found_where_it_hardly_grows():
    evidence = sought(divided("L17 long", str(LONG * (1 - 2e-4))))
    assert sum(count for _, count in evidence.steps) > 20


def test_nothing_is_found_beyond_it():
    assert sought(divided("L17 long", str(LONG * (1 + 1e-4)))) is None


@pytest.mark.parametrize(("scale", "grows"), [("1.026", True), ("1.025", False)])
def test_words_under_rules(scale, grows):
    """1 / 0.97482 is 1.02583, and the word has 8 steps."""
    evidence = sought(lossy_network(Fraction(scale)))
    assert (evidence is not None) is grows
    if grows:
        assert sum(count for _, count in evidence.steps) == 8


def test_the_least_growth_of_forms_is_near_that_of_words():
    program = FormsProgram(memory.draw_memory(golden(1), 1))
    assert memory.least_growth(program, Allowance(), 1.6180339887, 1.6) is None
    rate, solution = memory.least_growth(program, Allowance(), 1.6180339887, 2.0)
    assert 1.618 < rate < 1.6185
    assert all(np.linalg.eigvalsh(Q)[0] > 0 for Q in solution.forms)
    *_, (word, growth) = memory.words_in_norms(program, solution, Allowance(), 1.0)
    assert sorted(word) == [0, 1]
    assert growth == pytest.approx((1 + 5**0.5) / 2)
