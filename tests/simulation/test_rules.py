"""Rules of switching on a grid: every path is an admissible signal, and every signal a path."""

from dataclasses import replace
from fractions import Fraction
from itertools import groupby, pairwise

import numpy as np
import pytest

from nrs_design.proof.switching import Stay, Switching
from nrs_design.simulation.rules import Rules, fitting_step
from tests.proof.systems import family

FREE = family([[-1]], [[-2]], [[-3]], names="abc")
RING = (("a", "b"), ("b", "c"), ("c", "a"))
RULED = replace(
    FREE,
    switching=Switching(
        Fraction(3, 10), RING, stays=(("b", Stay(Fraction(1, 10), Fraction(1, 2))),)
    ),
)


def paths(rules, length):
    """Yield the modes of every path."""

    def walk(node, done):
        if len(done) == length:
            yield tuple(done)
            return
        for action in dict.fromkeys(rules.choices[node].tolist()):
            yield from walk(int(rules.target[action]), [*done, int(rules.mode[action])])

    return set(walk(0, []))


def admissible(signal, step):
    """Say directly whether a signal keeps the rules of `RULED`; the last stay may go on."""
    stays = [(mode, len(list(group)) * step) for mode, group in groupby(signal)]
    least, most = {0: 0.3, 1: 0.1, 2: 0.3}, {1: 0.5}
    follows = {0: 1, 1: 2, 2: 0}
    return (
        all(time >= least[mode] - 1e-9 for mode, time in stays[:-1])
        and all(time <= most.get(mode, 9) + 1e-9 for mode, time in stays)
        and all(follows[a] == b for (a, _), (b, _) in pairwise(stays))
    )


def test_free_switching_has_one_node():
    rules = Rules.create(FREE, 0.1)
    assert rules.choices.tolist() == [[0, 1, 2]]
    assert len(paths(rules, 4)) == 3**4


def test_paths_are_the_admissible_signals():
    step = fitting_step(RULED, 0.1)
    assert step == pytest.approx(0.1)
    every = np.array(np.meshgrid(*[range(3)] * 8)).reshape(8, -1).T.tolist()
    wanted = {tuple(signal) for signal in every if admissible(signal, step)}
    assert 10 < len(wanted) < 3**8
    assert paths(Rules.create(RULED, step), 8) == wanted


def test_a_stay_is_never_cut_short_on_a_grid_that_does_not_fit():
    step = 0.17
    for signal in paths(Rules.create(RULED, step), 7):
        assert admissible(signal, step)


def test_a_grid_fits_dwell_times():
    exact = replace(FREE, switching=Switching(Fraction(1, 7)))
    step = fitting_step(exact, 0.05)
    assert step <= 0.05
    assert (Fraction(1, 7) / Fraction(step)) == pytest.approx(round(1 / 7 / step))
    short = Switching(stays=(("a", Stay(Fraction(0), Fraction(1, 100))),))
    assert fitting_step(replace(FREE, switching=short), 0.1) <= 0.01


def test_a_mode_that_nothing_may_follow_is_refused():
    switching = Switching(transitions=(), stays=(("a", Stay(Fraction(0), Fraction(1))),))
    stuck = replace(FREE, switching=switching)
    with pytest.raises(ValueError, match="nothing may follow"):
        Rules.create(stuck, 0.5)
