"""The adversary finds what full enumeration finds, and no sweep makes a run less bad."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Reset, Stay, Switching
from nrs_design.simulation.adversary import held_signals, improve, settled_signals
from nrs_design.simulation.game import Aim, Game, Signals, play
from nrs_design.simulation.rules import Rules
from tests.proof.systems import family, matrix

STEPS, RUNS = 7, 400
A = np.array([[[0.7, 0.5], [-0.6, 0.6]], [[0.9, -0.4], [0.5, 0.4]], [[0.5, 0.1], [0.3, 0.8]]])
B = np.array([[[0.3], [0.1]], [[-0.1], [0.4]], [[0.2], [-0.3]]])
ROW = np.array([1.0, -0.5])


SYSTEM = family(*A.astype(str), time=Time.DISCRETE, names="abc")
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


def drawn_signals(game, steps, runs):
    """Paths through the rules with signs, all at random."""
    rng = np.random.default_rng(2)
    rules, node = game.rules, np.zeros(runs, dtype=int)
    actions = np.zeros((steps, runs), dtype=int)
    for k in range(steps):
        actions[k] = rng.choice(rules.choices, axis=1)[node]
        node = rules.target[actions[k]]
    shares = rng.choice([-1.0, 1.0], (steps, runs, game.disturbances))
    return Signals.from_rest(game, actions, shares)


def keeps_rules(game, signals):
    node = signals.nodes
    for actions in signals.actions:
        if not (game.rules.choices[node] == actions[:, None]).any(axis=1).all():
            return False
        node = game.rules.target[actions]
    return np.abs(signals.shares).max() <= 1


def at_end(game, signals):
    return np.abs(play(game, signals)[-1] @ ROW)


@pytest.mark.parametrize("name", RULES)
def test_of_many_signals_it_finds_the_worst_of_all(name):
    game = game_of(RULES[name])
    found = improve(game, AIM, drawn_signals(game, STEPS, RUNS), 30)
    assert keeps_rules(game, found)
    assert at_end(game, found).max() == pytest.approx(largest(game), rel=1e-12)


@pytest.mark.parametrize("name", RULES)
def test_of_held_signals_it_finds_a_large_part_of_the_worst(name):
    game = game_of(RULES[name])
    found = improve(game, AIM, held_signals(game, 0, STEPS), 30)
    assert 0.8 * largest(game) < at_end(game, found).max() <= largest(game) * (1 + 1e-12)


@pytest.mark.parametrize("name", RULES)
def test_no_sweep_makes_a_run_less_bad(name):
    game = game_of(RULES[name])
    signals, last = drawn_signals(game, 60, 8), np.zeros(8)
    for _ in range(6):
        signals = improve(game, AIM, signals, 1)
        values = at_end(game, signals)
        assert (values >= last * (1 - 1e-12)).all()
        last = values
    assert keeps_rules(game, signals)


@pytest.mark.parametrize("name", RULES)
def test_held_signals_stay_in_a_mode_where_rules_allow_it(name):
    """Of "longest", a is left after three steps, and held again after the two of another mode."""
    game = game_of(RULES[name])
    held = held_signals(game, 2, 9)
    assert keeps_rules(game, held)
    assert held.shares[:, :, 0].T.tolist() == [[0.0] * 2 + [s] * 9 for s in (1.0, -1.0)] * 3
    modes = game.rules.mode[held.actions]
    if name == "longest":
        assert modes[:, 0].tolist() == [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0]
        assert (modes[:, 2:] == [1, 1, 2, 2]).all()
    else:
        assert (modes == [0, 0, 1, 1, 2, 2]).all()


@pytest.mark.parametrize("name", RULES)
def test_a_span_goes_on_where_the_run_was(name):
    game = game_of(RULES[name])
    signals = drawn_signals(game, 20, 4)
    states, first = play(game, signals), np.array([0, 3, 7, 12])
    spans = signals.spans(game, states, first, 8)
    assert keeps_rules(game, spans)
    assert play(game, spans)[-1] == pytest.approx(states[first + 8, np.arange(4)])


def test_settled_signals_begin_where_held_ones_lead():
    game = game_of(RULES["free"])
    settled = settled_signals(game, 0, 1)
    led = play(game, held_signals(game, 0, 400))[-1]
    assert settled.actions[0].tolist() == [0, 0, 1, 1, 2, 2]
    assert settled.states == pytest.approx(led)


THROWN = Game(
    # In contact it is pulled back, in flight a push of the hand makes it move at one speed.
    np.array([[[0.5, -0.5, 1.0], [0.1, 0.9, 0.0]]]),
    np.array([[[0.5, 0.0, 1.0], [0.1, 1.0, 0.0]]]),
    np.zeros((0, 2)),
    Rules(*(np.zeros(1, dtype=int),) * 3, np.eye(2)[None], np.zeros((1, 1), dtype=int)),
)


def test_a_surface_is_met_in_steady_motion_after_the_approach():
    """At a speed of 2, by 0.2 in a step, over ten steps; the other way there is no surface."""
    settled = settled_signals(THROWN, 10, 3)
    assert settled.shares[0, :, 0].tolist() == [1.0, 1.0]
    pressed, flying = settled.states
    assert pressed == pytest.approx([1.0, 1.0])
    assert flying == pytest.approx([2.0, -2.0])
    states = play(THROWN, settled)[:, 1]
    assert states[10] == pytest.approx([2.0, 0.0])
    assert states[12, 1] > 0


def test_contact_is_lost_where_nothing_pushes():
    """A mass that is thrown: in contact it is pulled back, in flight it goes on as it was."""
    touch = np.array([[[0.9, -0.5, 1.0], [0.1, 1.0, 0.0]]])
    fly = np.array([[[1.0, 0.0, 0.0], [0.1, 1.0, 0.0]]])
    system = family([[1, 0], [0, 1]], time=Time.DISCRETE)
    game = Game(touch, fly, np.zeros((0, 2)), Rules.of(system, 1.0))
    assert game.flies(np.array([[1.0, 0.0], [1.0, 0.1], [1.0, -0.1]])).tolist() == [
        True,
        False,
        True,
    ]
    assert not play(game, held_signals(game, 5, 0)).any()
    pulled = replace(game, pulls=np.array([[1.0, 0.0]]))
    assert pulled.flies(np.array([[-1.0, 0.1]])).tolist() == [True]
