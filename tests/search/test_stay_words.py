"""Words of stays on a grid: those that grow are found where no single cycle does."""

import numpy as np
import pytest

from nrs_design.search.graph import Graph
from nrs_design.search.period import stay_words
from nrs_design.work import Allowance
from tests.literature.timed_loop import timed

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
