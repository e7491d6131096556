"""The game of an adversary: the loop on a grid of time, his aim, and his choices."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.channels import Channel
from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.simulation.norms import Array, Indices
from nrs_design.simulation.rules import Rules
from nrs_design.simulation.switched import expm


@dataclass(frozen=True, eq=False)
class Game:
    """A loop on a grid of time."""

    # Shape (m, n, n + c). Step of each mode in contact, from state and fractions of disturbances.
    maps: Array
    # Shape (m, n, n + c). The same without contact; shape (0, n, n + c) where contact is kept.
    flights: Array
    # Shape (q, n). Forces of tissue that could pull; without a positive force, contact is lost.
    pulls: Array
    rules: Rules  # Admissible mode sequences

    @classmethod
    def of(cls, system: SwitchedSystem, channels: Sequence[Channel], step: float) -> Game:
        """Lay a system of modes of one size on a grid of time, in floating point.

        Choices are held over a step, in s; one in discrete time. A ValueError if the rules of
        switching are too fine for this grid.
        """
        contact = system.contact
        free = () if contact is None else contact.free
        parts = [np.array([mode.A.floats() for mode in (*system.modes, *free)])]
        for channel in channels:
            columns = np.array([column.floats() for column in channel.columns])
            parts.append(columns * float(channel.bound))
        maps = np.concatenate(parts, axis=2)
        if system.time is Time.CONTINUOUS:
            maps = _held(maps, step)
        touching, flying = maps[: len(system.modes)], maps[len(system.modes) :]
        pulls = () if contact is None else contact.pulls
        rows = np.array([row.floats()[0] for row in pulls]).reshape(-1, system.order)
        flights = flying[free_counterparts(system)] if free else flying
        return cls(touching, flights, rows, Rules.of(system, step))

    @property
    def order(self) -> int:
        """Number of states n."""
        return int(self.maps.shape[1])

    @property
    def disturbances(self) -> int:
        """Number of disturbances c."""
        return int(self.maps.shape[2]) - self.order

    @property
    def losable(self) -> bool:
        """Whether contact may be lost."""
        return bool(len(self.flights))

    def flies(self, states: Array) -> NDArray[np.bool_]:
        """Tell at which states, shape (..., n), nothing is touched; shape (...)."""
        if not self.losable:
            return np.zeros(states.shape[:-1], dtype=np.bool_)
        lost = states[..., -1] <= 0
        if len(self.pulls):
            lost |= (states @ self.pulls.T <= 0).all(axis=-1)
        return np.asarray(lost)

    def gradients(self, p: Array, x: Array) -> Array:
        """Return gradients before a step from those after it, for every action.

        From p at every node, shape (N, S, n), along states x, shape (S, n) or (U, S, n), to shape
        (U, S, n + c).
        """
        lost = self.flies(x)
        # With one node all actions share their gradients.
        p = p if len(p) == 1 else p[self.rules.target]
        if not lost.any():
            return np.asarray(p @ self._touching)
        free = np.asarray(p @ self._flying)
        return free if lost.all() else np.where(lost[..., None], free, p @ self._touching)

    @cached_property
    def _touching(self) -> Array:
        """`maps` of every action."""
        return self.maps[self.rules.mode]

    @cached_property
    def _flying(self) -> Array:
        """`flights` of every action."""
        return self.flights[self.rules.mode]


@dataclass(frozen=True, eq=False)
class Aim:
    """What is to become large at the end of a run."""

    rows: Array  # Shape (r, n), over the state
    allowed: NDArray[np.bool_]  # Shape (m, r). Which of them apply in each mode.
    one_sided: bool  # Positive values alone count, and those without contact not at all

    def values(self, game: Game, states: Array, modes: Indices) -> tuple[Array, Array]:
        """Return the largest size at states in modes, and the row with the sign that has it.

        For S runs: states of shape (S, n) and modes (S,) give sizes (S,) and rows (S, n).
        """
        runs, found = np.arange(len(states)), states @ self.rows.T
        size = np.where(self.allowed[modes], found if self.one_sided else np.abs(found), -np.inf)
        best = size.argmax(axis=1)
        if self.one_sided:
            return np.where(game.flies(states), 0.0, size[runs, best]), self.rows[best]
        sign = np.where(found[runs, best] < 0, -1.0, 1.0)
        return size[runs, best], self.rows[best] * sign[:, None]


@dataclass(frozen=True, eq=False)
class Signals:
    """Choices of S runs, and their initial states."""

    actions: Indices  # Shape (K, S). Of `Rules`, one for each step.
    shares: Array  # Shape (K, S, c). Of the largest disturbances, from -1 to 1.
    states: Array  # Shape (S, n). At first.
    nodes: Indices  # Shape (S,). Of `Rules`, at first.

    @classmethod
    def from_rest(cls, game: Game, actions: Indices, shares: Array) -> Signals:
        """Return runs that begin at rest, in no mode yet."""
        runs = actions.shape[1]
        return cls(actions, shares, np.zeros((runs, game.order)), np.zeros(runs, dtype=np.int64))

    def only(self, runs: Indices) -> Signals:
        """Return the signals of some runs."""
        return Signals(
            self.actions[:, runs], self.shares[:, runs], self.states[runs], self.nodes[runs]
        )

    def spans(self, game: Game, states: Array, first: Indices, steps: int) -> Signals:
        """Return some steps of each run, from a step of its own on."""
        runs, rows = np.arange(len(first)), first + np.arange(steps)[:, None]
        before = game.rules.target[self.actions[first - 1, runs]]
        return Signals(
            self.actions[rows, runs],
            self.shares[rows, runs],
            states[first, runs],
            np.where(first > 0, before, self.nodes),
        )


def play(game: Game, signals: Signals) -> Array:
    """Simulate runs from their first states; shape (K + 1, S, n), at a switch before the reset."""
    steps, runs = signals.actions.shape
    states = np.zeros((steps + 1, runs, game.order))
    states[0] = signals.states
    for k in range(steps):
        states[k + 1] = _step(game, states[k], signals.actions[k], signals.shares[k])
    return states


def _step(game: Game, x: Array, action: Indices, shares: Array) -> Array:
    rules = game.rules
    mode = rules.mode[action]
    if len(rules.jumps) > 1:
        x = (rules.jumps[rules.jump[action]] @ x[:, :, None])[:, :, 0]
    maps = game.maps[mode]
    if game.losable:
        maps = np.where(game.flies(x)[:, None, None], game.flights[mode], maps)
    full = np.concatenate([x, shares], axis=1)
    return np.asarray((maps @ full[:, :, None])[:, :, 0])


def free_counterparts(system: SwitchedSystem) -> Indices:
    """Return the free mode of each mode after a loss of contact; shape (m,).

    It has the same controller, gains, motor and delay: the name with most parts in common.
    """
    assert system.contact is not None
    free = [mode.name.split("/") for mode in system.contact.free]
    found = []
    for mode in system.modes:
        parts = mode.name.split("/")
        common = [(names[0] == parts[0], len(set(names) & set(parts))) for names in free]
        found.append(max(range(len(free)), key=lambda i: common[i]))
    return np.array(found, dtype=np.int64)


def _held(maps: Array, step: float) -> Array:
    """Return the maps over a step of continuous time; shape (k, n, n + c)."""
    count, n, width = maps.shape
    square = np.concatenate([maps, np.zeros((count, width - n, width))], axis=1)
    return np.asarray(expm(square * step))[:, :n]
