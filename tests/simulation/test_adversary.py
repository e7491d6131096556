"""The adversary finds what full enumeration finds, and no sweep makes a run less bad."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.switching import Reset, Stay, Switching
from nrs_design.proof.system import SwitchedSystem
from nrs_design.simulation.adversary import improve, misjudged_signals, random_signals
from nrs_design.simulation.game import Aim, Game, play
from nrs_design.simulation.rules import Rules

STEPS, RUNS, ROUNDS = 7, 40, 8
A = np.array([[[0.7, 0.5], [-0.6, 0.6]], [[0.9, -0.4], [0.5, 0.4]], [[0.5, 0.1], [0.3, 0.8]]])
B = np.array([[[0.3], [0.1]], [[-0.1], [0.4]], [[0.2], [-0.3]]])
ROW = np.array([1.0, -0.5])


def matrix(rows):
    return RationalMatrix.from_rows([[Fraction(str(x)) for x in row] for row in rows])


SYSTEM = SwitchedSystem(
    name="three",
    time=Time.DISCRETE,
    states=("x", "y"),
    modes=tuple(Mode(name, matrix(M.tolist())) for name, M in zip("abc", A, strict=True)),
    assumptions=(),
)
RULES = {
    "free": Switching(),
    "dwell": Switching(Fraction(2)),
    "ring": Switching(Fraction(2), (("a", "b"), ("b", "c"), ("c", "a"))),
    "longest": Switching(stays=(("a", Stay(Fraction(2), Fraction(3))),)),
    "resets": Switching(resets=(Reset("a", "b", matrix([[1, 0], [0, -1]])),)),
}


def game_of(switching):
    system = replace(SYSTEM, switching=switching)
    maps = np.concatenate([A, B], axis=2)
    return Game(maps, np.zeros((0, 2, 3)), np.zeros((0, 2)), Rules.of(system, 1.0))


AIM = Aim(ROW[None], np.ones((3, 1), dtype=bool), one_sided=False)


def largest(game):
    """Try every path; under given modes the best disturbance has the sign of its effect."""
    rules, best = game.rules, 0.0

    def walk(node, taken):
        nonlocal best
        if len(taken) == STEPS:
            p, total = ROW, 0.0
            for action in reversed(taken):
                mode = rules.mode[action]
                total += abs(p @ B[mode])[0]
                p = p @ A[mode] @ rules.jumps[rules.jump[action]]
            best = max(best, total)
            return
        for action in dict.fromkeys(rules.choices[node].tolist()):
            walk(int(rules.target[action]), [*taken, action])

    walk(0, [])
    return best


@pytest.mark.parametrize("name", RULES)
def test_it_finds_the_worst_of_all_signals(name):
    """By improvement, and by runs that are continued with errors and improved again."""
    game, rng = game_of(RULES[name]), np.random.default_rng(3)
    signals, values = improve(game, AIM, random_signals(game, STEPS, RUNS, rng), 30)
    for _ in range(ROUNDS):
        best = signals.only(np.argsort(-values)[:4])
        fresh = misjudged_signals(game, AIM, best, 6, rng)
        signals, values = improve(game, AIM, best.beside(fresh), 30)
    assert values.max() == pytest.approx(largest(game), rel=1e-12)
    assert np.abs(play(game, signals)[-1] @ ROW) == pytest.approx(values)


@pytest.mark.parametrize("name", RULES)
def test_no_sweep_makes_a_run_less_bad(name):
    game = game_of(RULES[name])
    signals = random_signals(game, 60, 8, np.random.default_rng(2))
    last = np.zeros(8)
    for _ in range(6):
        signals, values = improve(game, AIM, signals, 1)
        assert (values >= last * (1 - 1e-12)).all()
        last = values
    nodes = np.zeros(8, dtype=int)
    for actions in signals.actions:
        allowed = game.rules.choices[nodes]
        assert (allowed == actions[:, None]).any(axis=1).all()
        nodes = game.rules.target[actions]
    assert np.abs(signals.shares).max() <= 1


def test_contact_is_lost_where_nothing_pushes():
    """A mass that is thrown: in contact it is pulled back, in flight it goes on as it was."""
    touch = np.array([[[0.9, -0.5, 1.0], [0.1, 1.0, 0.0]]])
    fly = np.array([[[1.0, 0.0, 0.0], [0.1, 1.0, 0.0]]])
    system = SwitchedSystem(
        name="one",
        time=Time.DISCRETE,
        states=("v", "delta"),
        modes=(Mode("a", matrix([[1, 0], [0, 1]])),),
        assumptions=(),
    )
    game = Game(touch, fly, np.zeros((0, 2)), Rules.of(system, 1.0))
    assert game.flies(np.array([[1.0, 0.0], [1.0, 0.1], [1.0, -0.1]])).tolist() == [
        True,
        False,
        True,
    ]
    signals = random_signals(game, 5, 1, np.random.default_rng(0))
    assert not play(game, signals).any()
    pulled = replace(game, pulls=np.array([[1.0, 0.0]]))
    assert pulled.flies(np.array([[-1.0, 0.1]])).tolist() == [True]
