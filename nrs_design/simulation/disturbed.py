"""Runs from rest in which an adversary chooses modes and disturbance to push an output far."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.evidence.abstract import Bound
from nrs_design.proof.system import Channel, Output, SwitchedSystem, Time
from nrs_design.simulation.contact import deflected
from nrs_design.simulation.norms import Array
from nrs_design.simulation.switched import SwitchedRun, fine_step, times

Indices = NDArray[np.int64]

# How often the adversary improves a run; after few of them it has settled.
SWEEPS = 12
# A run is as long as a set with this share needs to fill up to a thousandth, if steps are few.
_FILLED = 7.0
_FEWEST, _MOST = 100, 800


@dataclass(frozen=True)
class DisturbedMotions:
    """What one step makes of state and disturbance, in floating point.

    Parameters
    ----------
    touching, flying : ndarray, shapes (m, n, n + c) and (f, n, n + c)
        Maps of the state and of shares of the largest disturbances; no free ones where contact is
        kept.
    rows : ndarray, shape (r, n)
        The output at the corners of its ranges.
    """

    touching: Array
    flying: Array
    rows: Array

    @classmethod
    def of(
        cls, system: SwitchedSystem, channels: Sequence[Channel], output: Output, step: float
    ) -> DisturbedMotions:
        """Convert a system to floating point.

        Parameters
        ----------
        system : SwitchedSystem
            With its modes, and the free ones where contact may be lost.
        channels : sequence of Channel
            The disturbances.
        output : Output
            What they move.
        step : float
            Time of a step in s, over which disturbances are held; one in discrete time.
        """
        free = () if system.contact is None else system.contact.free
        parts = [np.array([mode.A.floats() for mode in (*system.modes, *free)])]
        for channel in channels:
            columns = np.array([column.floats() for column in channel.columns])
            parts.append(columns * float(channel.bound))
        maps = np.concatenate(parts, axis=2)
        if system.time is Time.CONTINUOUS:
            maps = _held(maps, step)
        count = len(system.modes)
        rows = np.array([row.floats()[0] for row in output.rows])
        return cls(maps[:count], maps[count:], rows)

    @property
    def disturbances(self) -> int:
        """How many disturbances there are."""
        return int(self.touching.shape[2] - self.touching.shape[1])

    @property
    def maps(self) -> Array:
        """The maps of all modes, those in contact first."""
        return np.concatenate([self.touching, self.flying])

    def possible(self, states: Array) -> NDArray[np.bool_]:
        """Tell which modes are possible at states, shape (S, n); shape (S, k)."""
        count, others = len(self.touching), len(self.flying)
        flies = states[:, -1:] <= 0 if others else np.zeros((len(states), 1), dtype=np.bool_)
        return np.concatenate(
            [np.repeat(~flies, count, axis=1), np.repeat(flies, others, axis=1)], axis=1
        )

    def outputs(self, states: Array) -> Array:
        """Return the output at states, shape (..., n), for every row; shape (..., r)."""
        w = deflected(states) if len(self.flying) else states
        return np.asarray(w @ self.rows.T)


def worst_run(system: SwitchedSystem, bound: Bound) -> tuple[SwitchedRun, DisturbedMotions]:
    """Simulate an adversary against a bound, for about as long as its set takes to fill.

    Parameters
    ----------
    system : SwitchedSystem
        That the bound is about.
    bound : Bound
        Whose disturbances act, and whose output is to become large.
    """
    share, step = float(bound.share), fine_step(system)
    rate = -np.log1p(-share) if system.time is Time.DISCRETE else share
    steps = int(np.clip(_FILLED / (rate * step), _FEWEST, _MOST))
    motions = DisturbedMotions.of(system, bound.channels, bound.output, step)
    return worst_disturbed(motions, step, steps), motions


def worst_output(system: SwitchedSystem, bound: Bound) -> float:
    """Return how large the output of a bound becomes in `worst_run`.

    Parameters
    ----------
    system, bound
        As for `worst_run`.
    """
    response, motions = worst_run(system, bound)
    return float(np.abs(motions.outputs(response.state)).max())


def worst_disturbed(motions: DisturbedMotions, step: float, steps: int) -> SwitchedRun:
    """Simulate an adversary from rest, who makes the output at the end as large as he can.

    He begins with the largest disturbance, held, in one mode, and then improves the run backwards
    from its end: with the gradient of the output, the best mode and sign at every step. The best of
    all these runs is a bad run, not the worst one: nothing is proved by it.

    Parameters
    ----------
    motions : DisturbedMotions
        What can happen.
    step : float
        Time of a step, in s or in steps.
    steps : int
        Number of decisions N.

    Returns
    -------
    SwitchedRun
        Its modes are those in contact, the free ones after them.
    """
    count = len(motions.touching)
    wanted = np.repeat(np.arange(count), 2)[:, None].repeat(steps, axis=1)
    signs = np.tile([[[1.0]], [[-1.0]]], (count, steps, motions.disturbances))
    best, chosen, largest = np.zeros(0), np.zeros(0, dtype=np.int64), -1.0
    for _ in range(SWEEPS):
        states, modes = follow(motions, wanted, signs)
        reached = np.abs(motions.outputs(states)).max(axis=(0, 2))
        if reached.max() > largest:
            run = int(reached.argmax())
            best, chosen, largest = states[:, run], modes[:, run], float(reached.max())
        wanted, signs = _improve(motions, states)
    return SwitchedRun(times(step, steps), best, chosen)


def follow(motions: DisturbedMotions, wanted: Indices, signs: Array) -> tuple[Array, Indices]:
    """Simulate many runs from rest.

    Parameters
    ----------
    motions : DisturbedMotions
        What can happen.
    wanted : ndarray of int, shape (S, N)
        The mode of every run and step, where it is possible; otherwise one in its place.
    signs : ndarray, shape (S, N, c)
        Shares of the largest disturbances, from -1 to 1.

    Returns
    -------
    ndarray of shape (N + 1, S, n), and of int of shape (N, S)
        States, and the modes that were in force.
    """
    maps, count, others = motions.maps, len(motions.touching), len(motions.flying)
    runs, steps = wanted.shape
    states = np.zeros((steps + 1, runs, maps.shape[1]))
    modes = np.zeros((steps, runs), dtype=np.int64)
    for k in range(steps):
        mode = wanted[:, k] % count
        if others:
            flies = states[k, :, -1] <= 0
            mode = np.where(flies, count + (wanted[:, k] - count) % others, mode)
        full = np.concatenate([states[k], signs[:, k]], axis=1)
        states[k + 1] = (maps[mode] @ full[:, :, None])[:, :, 0]
        modes[k] = mode
    return states, modes


def _improve(motions: DisturbedMotions, states: Array) -> tuple[Indices, Array]:
    """Return the best mode and signs at every step, as far as the gradient along a run tells."""
    n = states.shape[2]
    maps, runs = motions.maps, np.arange(states.shape[1])
    ends = motions.outputs(states[-1])
    rows = np.abs(ends).argmax(axis=1)
    gradient = motions.rows[rows] * np.where(ends[runs, rows] < 0, -1.0, 1.0)[:, None]
    steps = len(states) - 1
    wanted = np.zeros((len(runs), steps), dtype=np.int64)
    signs = np.zeros((len(runs), steps, motions.disturbances))
    for k in range(steps - 1, -1, -1):
        pulled = np.tensordot(gradient, maps, axes=(1, 1))
        gain = (pulled[:, :, :n] @ states[k, :, :, None])[:, :, 0]
        gain = gain + np.abs(pulled[:, :, n:]).sum(axis=2)
        best = np.where(motions.possible(states[k]), gain, -np.inf).argmax(axis=1)
        own = pulled[runs, best]
        wanted[:, k], signs[:, k] = best, np.where(own[:, n:] < 0, -1.0, 1.0)
        gradient = own[:, :n]
    return wanted, signs


def _held(maps: Array, step: float) -> Array:
    """Return the maps over a step of continuous time; shape (k, n, n + c)."""
    from scipy.linalg import expm

    count, n, width = maps.shape
    square = np.concatenate([maps, np.zeros((count, width - n, width))], axis=1)
    return np.asarray(expm(square * step))[:, :n]
