"""Search for growing periodic signals."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Clock, Reset, Switching
from nrs_design.search.acceptance import first_accepted
from nrs_design.search.certify import certify
from nrs_design.search.family import Family, floats_in_silence
from nrs_design.search.graph import Graph
from nrs_design.search.period import search_period, search_rounds, stay_words
from nrs_design.search.work import Allowance
from tests.literature.timed_loop import timed
from tests.proof.systems import (
    bouncing_in_steps,
    branicky,
    dayawansa_martin,
    doubled_in_turns,
    family,
    geromel_colaneri,
    golden,
    oscillator,
)
from tests.proof.truth import holds
from tests.search.support import found, outcome


def search(system):
    return found(search_period, system)


@pytest.mark.parametrize(
    "system", [branicky(), dayawansa_martin("11.27"), oscillator(7), golden("0.6181")]
)
def test_what_is_found_grows(system):
    evidence = search(system)
    assert evidence.find_fault(system) is None
    assert holds(system, evidence)


@pytest.mark.parametrize(
    "system", [dayawansa_martin("11.2"), oscillator("6.9"), golden("0.618"), geromel_colaneri(3)]
)
def test_nothing_is_found_in_stable_families(system):
    assert search(system) is None


def test_words_of_several_letters():
    # A shift of four states around a circle grows only over all four modes in order.
    def step(k):
        target = (k + 1) % 4
        return [[int(i == target and j == k) * 2 for j in range(4)] for i in range(4)]

    system = family(*map(step, range(4)), time=golden("1").time)
    evidence = search(system)
    assert {name for name, _ in evidence.steps} == {"m0", "m1", "m2", "m3"}
    assert holds(system, evidence)


@pytest.mark.parametrize(
    "switching", [Switching(transitions=(("m0", "m1"),)), Switching(fixed_ends=(("m0", "m1"),))]
)
def test_rules_are_obeyed(switching):
    system = branicky()
    rows = [mode.A.fractions() for mode in system.modes]
    assert search(family(*rows, switching=switching)) is None


@pytest.mark.parametrize("lie", [1e3, -1e3])
def test_matrices_that_lie_give_no_verdict(lie):
    system = dayawansa_martin(5)
    lying = replace(Family.of(system), matrices=np.array([[[0.1, lie], [-lie, 0.1]]] * 2))
    with floats_in_silence():
        assert first_accepted(search_period(lying), system)[0] is None


def test_resets_that_grow_a_little_need_quick_switching():
    """1.001 at every switch, exp(-20 t) in between: only switching within 50 us grows."""
    gain = RationalMatrix.from_rows([[Fraction(1001, 1000)]])
    resets = (Reset("m0", "m1", gain), Reset("m1", "m0", gain))
    system = family([[-20]], [["-0.1"]], switching=Switching(resets=resets))
    evidence = search(system)
    assert evidence is not None
    assert evidence.find_fault(system) is None


def test_a_round_that_grows():
    evidence = found(search_rounds, doubled_in_turns(3))
    assert evidence.doublings is not None
    assert [(name, int(count)) for name, count in evidence.steps] == [("m0", 1), ("m1", 2)]
    assert certify(doubled_in_turns(3)).evidence == evidence


def test_two_rounds_that_grow_in_turn():
    """Either alone halves all, and one after the other they grow by two and a quarter."""
    pair = [["1/2", 2], [0, "1/2"]], [["1/2", 0], [2, "1/2"]]
    rest = [[1, 0], [0, 1]]
    system = replace(family(*pair, rest, time=Time.DISCRETE), clock=Clock(3, ("m0", "m1")))
    evidence = found(search_rounds, system)
    assert {name for name, _ in evidence.steps} == {"m0", "m1", "m2"}


def test_what_decays_is_not_refuted():
    assert outcome(search_rounds, doubled_in_turns(4))[0] is None
    assert outcome(search_rounds, bouncing_in_steps())[0] is None


MOTION = ([[0, 1], [0, 0]], [[0], ["126.7"]])
GAIN = [[-50, "-11.8"]]


def words(period, delay, system=None):
    system = system or timed(MOTION, GAIN, period, delay)
    graph = Graph.of(system, np.array([mode.A.floats() for mode in system.modes]))
    return graph, [*stay_words(graph, Allowance(0.5))]


def test_delays_in_turn():
    graph, found = words(("1e-3", "1e-3"), (0, "0.6e-3"))
    cycle, times = found[-1]
    assert graph.growth(cycle, times) > 0
    # It begins with the first mode, and takes both ends of the delay.
    assert [graph.matrices.shape[0], *graph.modes(cycle)[:2]] == [2, 0, 1]
    assert times[::2].min() == pytest.approx(0.6e-9)
    assert times[::2].max() == pytest.approx(0.6e-3)
    assert (graph.admissible(cycle, times) == times).all()


def test_the_best_word_where_none_grows():
    graph, found = words(("1e-3", "1e-3"), (0, "0.3e-3"))
    ((cycle, times),) = found
    assert graph.growth(cycle, times) < 0


def test_no_words_where_nothing_varies():
    assert words(("1e-3", "1e-3"), ("0.6e-3", "0.6e-3"))[1] == []
