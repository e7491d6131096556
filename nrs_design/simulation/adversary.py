"""An adversary who improves runs, forward and backward, until no choice does more harm.

Between two of his choices the loop is linear. So from the end of a run backward, the gradient of
what he wants to be large tells for each step what every admissible choice would add, if all before
it stayed and all after it were chosen anew: the discrete maximum principle, with dynamic
programming over the rules of switching. Where contact is kept, no sweep makes a run less bad.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from nrs_design.simulation.game import Aim, Game, Signals, play
from nrs_design.simulation.norms import Array

# Fractions of a run after which the new choices continue it.
_CUTS = (0.0, 0.3, 0.5, 0.7, 0.8, 0.9, 0.95)
_NO_GAIN = 1e-5
# A mode settles if no motion of it keeps more than this share of itself in a step.
_SETTLES = 1 - 1e-9
_SIGNS = (1.0, -1.0)


def held_signals(game: Game, rest: int, steps: int) -> Signals:
    """Return the largest disturbances, held in either direction in one mode after the other.

    Every mode of the game may follow every mode.
    """
    rules, modes = game.rules, np.arange(len(game.maps))
    actions = np.zeros((rest + steps, len(modes)), dtype=np.int64)
    node = np.zeros_like(modes)
    for k in range(len(actions)):
        choices = rules.choices[node]
        wanted = rules.mode[choices] == modes[:, None]
        actions[k] = choices[modes, wanted.argmax(axis=1)]
        node = rules.target[actions[k]]
    shares = np.tile(_SIGNS, len(modes))[None, :, None] * np.ones((rest + steps, 1, 1))
    shares[:rest] = 0.0
    return Signals.from_rest(
        game, np.repeat(actions, 2, axis=1), np.repeat(shares, game.disturbances, axis=2)
    )


def settled_signals(game: Game, approach: int, steps: int) -> Signals:
    """Return the signals of `held_signals` from the states that they settle at.

    Pressed into the environment, or in steady motion towards a surface.
    """
    found = [
        (mode, sign, state)
        for mode in range(len(game.maps))
        for sign in _SIGNS
        for state in _settled(game, mode, sign, approach)
    ]
    shape = approach + steps, 1
    modes = np.array([mode for mode, _, _ in found], dtype=np.int64)
    signs = np.array([sign for _, sign, _ in found])[:, None] * np.ones(game.disturbances)
    return Signals(
        np.tile(modes, shape),
        np.tile(signs, (*shape, 1)),
        np.array([state for _, _, state in found]).reshape(-1, game.order),
        np.zeros_like(modes),
    )


def _settled(game: Game, mode: int, sign: float, approach: int) -> Iterator[Array]:
    """Yield the states that a mode settles at, in contact and on the way to the surface."""
    n = game.order
    A, b = game.maps[mode, :, :n], sign * game.maps[mode, :, n:].sum(axis=1)
    if _settles(A):
        state = np.linalg.solve(np.eye(n) - A, b)
        if not game.flies(state):
            yield state
    if not game.losable:
        return
    # The deflection, which is the last state, moves on; the others do not feel it.
    A, b = game.flights[mode, :, :n], sign * game.flights[mode, :, n:].sum(axis=1)
    if _settles(A[:-1, :-1]) and not A[:-1, -1].any():
        state = np.append(np.linalg.solve(np.eye(n - 1) - A[:-1, :-1], b[:-1]), 0.0)
        if (way := float(A[-1] @ state + b[-1])) > 0:
            state[-1] = -way * approach
            yield state


def _settles(A: Array) -> bool:
    return not A.size or bool(np.abs(np.linalg.eigvals(A)).max() < _SETTLES)


def improve(game: Game, aim: Aim, signals: Signals, sweeps: int) -> Signals:
    """Improve runs until a sweep gains nothing, or there have been enough; return the best."""
    states = play(game, signals)
    value = _at_end(game, aim, signals, states)
    actions, shares = signals.actions.copy(), signals.shares.copy()
    best = replace(signals, actions=actions, shares=shares)
    # Runs that the last sweep has improved; the others have converged.
    moving = np.arange(len(value))
    for _ in range(sweeps):
        if not len(moving):
            break
        now = best.only(moving)
        policy = _Policy.against(game, aim, now, states[:, moving])
        fresh = policy.follow(game, now)
        reached = play(game, fresh)
        values = _at_end(game, aim, fresh, reached)
        picked = values.reshape(len(_CUTS), -1).argmax(axis=0) * len(moving)
        picked += np.arange(len(moving))
        gained = values[picked] > value[moving] * (1 + _NO_GAIN)
        moving, picked = moving[gained], picked[gained]
        actions[:, moving], shares[:, moving] = fresh.actions[:, picked], fresh.shares[:, picked]
        states[:, moving], value[moving] = reached[:, picked], values[picked]
    return best


def _at_end(game: Game, aim: Aim, signals: Signals, states: Array) -> Array:
    modes = game.rules.mode[signals.actions[-1]]
    return aim.values(game, states[-1], modes)[0]


@dataclass(frozen=True, eq=False)
class _Policy:
    """The best action and signs at every step and node, shapes (K, N, S) and (K, N, S, c)."""

    actions: NDArray[np.int32]
    signs: NDArray[np.int8]

    @classmethod
    def against(cls, game: Game, aim: Aim, signals: Signals, states: Array) -> _Policy:
        """Go backward along runs, with the gradient at every node."""
        rules, n = game.rules, game.order
        steps, runs = signals.actions.shape
        nodes = len(rules.choices)
        actions = np.zeros((steps, nodes, runs), dtype=np.int32)
        signs = np.zeros((steps, nodes, runs, game.disturbances), dtype=np.int8)
        # The value of a run at a node is p x + c.
        p, c = _final(game, aim, states[-1], runs), np.zeros((nodes, runs))
        reset = len(rules.jumps) > 1
        taken = rules.jumps[rules.jump]
        column, row = np.arange(runs), np.arange(nodes)[:, None]
        for k in range(steps - 1, -1, -1):
            x = (taken @ states[k].T).transpose(0, 2, 1) if reset else states[k]
            pulled = game.gradients(p, x)
            added = np.abs(pulled[:, :, n:]).sum(axis=2) + c[rules.target]
            worth = (pulled[:, :, :n] * x).sum(axis=2) + added
            action = rules.choices[row, worth[rules.choices].argmax(axis=1)]
            own = pulled[action, column]
            actions[k], signs[k] = action, np.where(own[:, :, n:] < 0, -1, 1)
            p, c = own[:, :, :n], added[action, column]
            if reset:
                p = (p[:, :, None] @ taken[action])[:, :, 0]
        return cls(actions, signs)

    def follow(self, game: Game, signals: Signals) -> Signals:
        """Return the choices of runs that follow the policy from each cut on."""
        rules = game.rules
        steps, runs = signals.actions.shape
        first = np.repeat((np.array(_CUTS) * steps).astype(int), runs)
        column = np.tile(np.arange(runs), len(_CUTS))
        fresh = signals.only(column)
        actions, shares, node = fresh.actions, fresh.shares, fresh.nodes
        for k in range(steps):
            new = k >= first
            actions[k] = np.where(new, self.actions[k, node, column], actions[k])
            shares[k] = np.where(new[:, None], self.signs[k, node, column], shares[k])
            node = rules.target[actions[k]]
        return fresh


def _final(game: Game, aim: Aim, ends: Array, runs: int) -> Array:
    """Return the row of the aim at the end, at every node; shape (N, S, n)."""
    rules = game.rules
    p = np.zeros((len(rules.choices), runs, game.order))
    # Every action into a node has the mode of the node; a single node has every mode.
    if len(rules.choices) == 1:
        free = replace(aim, allowed=np.ones_like(aim.allowed))
        p[0] = free.values(game, ends, np.zeros(runs, dtype=np.int64))[1]
        return p
    for node, mode in dict(zip(rules.target.tolist(), rules.mode.tolist(), strict=True)).items():
        p[node] = aim.values(game, ends, np.full(runs, mode))[1]
    return p
