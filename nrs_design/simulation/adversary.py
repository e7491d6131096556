"""An adversary who improves runs from rest, forward and backward, until no choice does more harm.

Between two of his choices the loop is linear. So from the end of a run backward, the gradient of
what he wants to be large tells for each step what every admissible choice would add, if all before
it stayed and all after it were chosen anew: the discrete maximum principle, with dynamic
programming over the rules of switching. Where contact is kept, no sweep makes a run less bad.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from nrs_design.simulation.game import Aim, Game, Signals, play
from nrs_design.simulation.norms import Array

# Where a run is continued by the new choices: from these shares of its length on.
_CUTS = (0.0, 0.5, 0.8)
_NO_GAIN = 1e-5
# Mean length of a change, as a share of a run.
_SPAN = 0.06
# Of misjudged choices: from one run to the other, small ones or large ones.
_ERRORS = (0.01, 0.5)


def held_signals(game: Game, steps: int) -> Signals:
    """Return the largest disturbances, held in either direction in one mode after the other.

    Parameters
    ----------
    game : Game
        In which every mode may follow every mode.
    steps : int
        Number of steps K.
    """
    modes = len(game.rules.mode)
    actions = np.tile(np.repeat(np.arange(modes), 2), (steps, 1))
    signs = np.tile([1.0, -1.0], modes)[None, :, None]
    return Signals(actions, np.tile(signs, (steps, 1, game.disturbances)))


def random_signals(game: Game, steps: int, runs: int, rng: np.random.Generator) -> Signals:
    """Draw admissible signals: choices that are kept for random times, after a while at rest.

    Parameters
    ----------
    game : Game
        With its rules.
    steps, runs : int
        Number of steps K and of runs S.
    rng : numpy.random.Generator
        Seeded.
    """
    rules, c = game.rules, game.disturbances
    actions = np.zeros((steps, runs), dtype=np.int64)
    shares = np.zeros((steps, runs, c))
    rest = rng.uniform(0, 0.9, runs) * steps
    # Some switch hardly ever, others at almost every step.
    pace = np.exp(rng.uniform(np.log(0.5 / steps), np.log(0.9), runs))
    node = np.zeros(runs, dtype=np.int64)
    last = np.zeros(runs, dtype=np.int64)
    share = rng.choice([-1.0, 1.0], (runs, c))
    for k in range(steps):
        choices = rules.choices[node]
        drawn = choices[np.arange(runs), rng.integers(0, choices.shape[1], runs)]
        # What was chosen last, or what stays in the mode, comes first among the choices.
        stays = np.where((choices == last[:, None]).any(axis=1), last, choices[:, 0])
        turns = rng.random(runs) < pace
        last = np.where(turns | (k == 0), drawn, stays)
        flips = rng.random((runs, c)) < pace[:, None]
        share = np.where(flips, -share, share)
        actions[k], node = last, rules.target[last]
        shares[k] = np.where(k < rest[:, None], 0.0, share)
    return Signals(actions, shares)


def changed_signals(game: Game, signals: Signals, copies: int, rng: np.random.Generator) -> Signals:
    """Change each run within a random span of time, so that it may come to another best one.

    Parameters
    ----------
    game : Game
        With its rules.
    signals : Signals
        Of S runs.
    copies : int
        How often each is changed.
    rng : numpy.random.Generator
        Seeded.

    Returns
    -------
    Signals
        Of S times as many runs as copies: all of them once, then all of them again.
    """
    steps = len(signals.actions)
    actions = np.tile(signals.actions, copies)
    shares = np.tile(signals.shares, (1, copies, 1))
    count, k = actions.shape[1], np.arange(steps)[:, None]
    begin = rng.uniform(0, steps, count)
    span = (k >= begin) & (k < begin + 1 + rng.exponential(_SPAN * steps, count))
    kind = rng.integers(0, 3, count)
    if len(game.rules.choices) == 1:
        # Where rules are to be kept, a change of one action may forbid what comes after it.
        drawn = rng.integers(0, len(game.rules.mode), count)
        actions = np.where(span & (kind != 1), drawn, actions)
    shares = np.where((span & (kind != 0))[:, :, None], -shares, shares)
    return Signals(actions, shares)


def misjudged_signals(
    game: Game, aim: Aim, signals: Signals, copies: int, rng: np.random.Generator
) -> Signals:
    """Choose anew along each run, with errors: it keeps the rules, and may come to a better one.

    Parameters
    ----------
    game, signals, copies, rng
        As for `changed_signals`, which it is for where rules are to be kept.
    aim : Aim
        What is to become large.
    """
    runs = np.tile(np.arange(signals.actions.shape[1]), copies)
    many = signals.only(runs)
    policy = _Policy.against(game, aim, many, play(game, many), rng)
    fresh, cut = policy.follow(game, many), rng.integers(0, len(_CUTS), len(runs))
    return fresh.only(cut * len(runs) + np.arange(len(runs)))


def improve(game: Game, aim: Aim, signals: Signals, sweeps: int) -> tuple[Signals, Array]:
    """Improve runs until a sweep gains nothing, or there have been enough.

    Parameters
    ----------
    game : Game
        What can happen.
    aim : Aim
        What is to become large at the end of each run.
    signals : Signals
        Of the runs to begin with.
    sweeps : int
        Most sweeps.

    Returns
    -------
    Signals, and ndarray of shape (S,)
        The best that each run came to, and what was wanted at its end.
    """
    states = play(game, signals)
    value = _at_end(game, aim, signals, states)
    actions, shares = signals.actions.copy(), signals.shares.copy()
    # Runs that the last sweep has improved; the others have come to where they stay.
    moving = np.arange(len(value))
    for _ in range(sweeps):
        if not len(moving):
            break
        now = Signals(actions[:, moving], shares[:, moving])
        policy = _Policy.against(game, aim, now, states[:, moving])
        fresh = policy.follow(game, now)
        reached = play(game, fresh)
        values = _at_end(game, aim, fresh, reached)
        best = values.reshape(len(_CUTS), -1).argmax(axis=0)
        picked = best * len(moving) + np.arange(len(moving))
        gained = values[picked] > value[moving] * (1 + _NO_GAIN)
        moving, picked = moving[gained], picked[gained]
        actions[:, moving], shares[:, moving] = fresh.actions[:, picked], fresh.shares[:, picked]
        states[:, moving], value[moving] = reached[:, picked], values[picked]
    return Signals(actions, shares), value


def _at_end(game: Game, aim: Aim, signals: Signals, states: Array) -> Array:
    modes = game.rules.mode[signals.actions[-1]]
    return aim.values(game, states[-1], modes)[0]


@dataclass(frozen=True, eq=False)
class _Policy:
    """The best action and signs at every step and node, shapes (K, N, S) and (K, N, S, c)."""

    actions: NDArray[np.int32]
    signs: NDArray[np.int8]

    @classmethod
    def against(
        cls,
        game: Game,
        aim: Aim,
        signals: Signals,
        states: Array,
        rng: np.random.Generator | None = None,
    ) -> _Policy:
        """Go backward along runs, with the gradient at every node; perhaps not quite for the best.

        With a generator, every choice is judged with an error of its own.
        """
        rules, n = game.rules, game.order
        steps, runs = signals.actions.shape
        nodes = len(rules.choices)
        actions = np.zeros((steps, nodes, runs), dtype=np.int32)
        signs = np.zeros((steps, nodes, runs, game.disturbances), dtype=np.int8)
        # What a run is worth at a node is p x + c.
        p, c = _final(game, aim, states[-1], runs), np.zeros((nodes, runs))
        pull, reset = _Pull(game), len(rules.jumps) > 1
        taken = rules.jumps[rules.jump]
        least, most = map(math.log, _ERRORS)
        errors = 0.0 if rng is None else np.exp(rng.uniform(least, most, runs))
        column, row = np.arange(runs), np.arange(nodes)[:, None]
        for k in range(steps - 1, -1, -1):
            x = (taken @ states[k].T).transpose(0, 2, 1) if reset else states[k]
            pulled = pull(p, x)
            added = np.abs(pulled[:, :, n:]).sum(axis=2) + c[rules.target]
            worth = (pulled[:, :, :n] * x).sum(axis=2) + added
            if rng is not None:
                worth *= 1 + errors * rng.standard_normal(worth.shape)
            action = rules.choices[row, worth[rules.choices].argmax(axis=1)]
            own = pulled[action, column]
            actions[k], signs[k] = action, np.where(own[:, :, n:] < 0, -1, 1)
            p, c = own[:, :, :n], added[action, column]
            if reset:
                p = (p[:, :, None] @ taken[action])[:, :, 0]
        return cls(actions, signs)

    def follow(self, game: Game, signals: Signals) -> Signals:
        """Return what is chosen by runs that are the old ones at first, for every cut."""
        rules = game.rules
        steps, runs = signals.actions.shape
        first = np.repeat((np.array(_CUTS) * steps).astype(int), runs)
        actions = np.tile(signals.actions, len(_CUTS))
        shares = np.tile(signals.shares, (1, len(_CUTS), 1))
        column = np.tile(np.arange(runs), len(_CUTS))
        node = np.zeros(len(first), dtype=np.int64)
        for k in range(steps):
            new = k >= first
            actions[k] = np.where(new, self.actions[k, node, column], actions[k])
            shares[k] = np.where(new[:, None], self.signs[k, node, column], shares[k])
            node = rules.target[actions[k]]
        return Signals(actions, shares)


class _Pull:
    """Gradients before a step from those after it, for every action; shape (U, S, n + c)."""

    def __init__(self, game: Game) -> None:
        self._game, self._target = game, game.rules.target
        self._maps, self._flights = (
            maps[game.rules.mode] if len(maps) else maps for maps in (game.maps, game.flights)
        )

    def __call__(self, p: Array, x: Array) -> Array:
        """Pull back p, shape (N, S, n), along states x, shape (S, n) or (U, S, n)."""
        lost = self._game.flies(x)
        if not lost.any():
            return self._back(p, self._maps)
        free = self._back(p, self._flights)
        return free if lost.all() else np.where(lost[..., None], free, self._back(p, self._maps))

    def _back(self, p: Array, maps: Array) -> Array:
        # With one node all actions share their gradients.
        return np.asarray((p if len(p) == 1 else p[self._target]) @ maps)


def _final(game: Game, aim: Aim, ends: Array, runs: int) -> Array:
    """Return what is wanted at the end as a row, at every node; shape (N, S, n)."""
    rules = game.rules
    p = np.zeros((len(rules.choices), runs, game.order))
    # The mode of a node is that of any action that leads to it; of one node, any mode's.
    if len(rules.choices) == 1:
        free = replace(aim, allowed=np.ones_like(aim.allowed))
        p[0] = free.values(game, ends, np.zeros(runs, dtype=np.int64))[1]
        return p
    for node, mode in dict(zip(rules.target.tolist(), rules.mode.tolist(), strict=True)).items():
        p[node] = aim.values(game, ends, np.full(runs, mode))[1]
    return p
