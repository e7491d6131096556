"""The worst run that an adversary finds, for each quantity that has a limit.

It is a run that may happen, so the largest value that may occur is at least as large; a certified
bound says that it is at most so large. What is found is no bound.

Between two of his choices the loop is linear. So from the end of a run backward, the gradient of
what he wants to be large tells for each step what every admissible choice would add, if all before
it stayed and all after it were chosen anew: the discrete maximum principle, with dynamic
programming over the rules of switching. Where contact is kept, no sweep makes a run less bad.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product

import numpy as np
from numpy.typing import NDArray

from nrs_design.models.contact.environment import Environment
from nrs_design.proof.channels import Output
from nrs_design.proof.evidence.abstract import Bound
from nrs_design.proof.mode import Time
from nrs_design.proof.switching import ARBITRARY
from nrs_design.proof.system import SwitchedSystem
from nrs_design.simulation.norms import Array, Indices, deflected
from nrs_design.simulation.rules import Rules, fitting_step
from nrs_design.simulation.switched import (
    all_modes,
    expm,
    fine_step,
    mode_eigenvalues,
    mode_matrices,
)

# The adversary improves the last _HORIZON steps of the _CANDIDATES runs that come farthest while a
# choice is held, for at most _LONGEST_HOLD steps, in at most _SWEEPS sweeps.
_HORIZON, _CANDIDATES, _LONGEST_HOLD, _SWEEPS = 600, 8, 3000, 15
# Fractions of a run after which the new choices continue it.
_CUTS = (0.0, 0.3, 0.5, 0.7, 0.8, 0.9, 0.95)
_NO_GAIN = 1e-5
# Time constants until a motion has faded to a thousandth.
_FADED = 8.0
# A mode settles if no motion of it keeps more than this share of itself in a step.
_SETTLES = 1 - 1e-9
DEFLECTION = "deflection"


@dataclass(frozen=True, eq=False)
class WorstRun:
    """The worst run of an adversary for a quantity."""

    output: Output  # The quantity
    value: float  # Its size at the end of the run
    time: Array  # Shape (K + 1,). In s.
    # Shape (K + 1, n). From rest, or settled under disturbances that were held for long.
    states: Array
    mode: Indices  # Shape (K,). Mode of each step; indices of free modes follow the contact modes.
    disturbances: Array  # Shape (K, c). Held over each step, in the units of the channels.


def worst_runs(
    system: SwitchedSystem, outputs: Sequence[Output], environments: Sequence[Environment] = ()
) -> tuple[WorstRun, ...]:
    """Let an adversary choose modes and disturbances from rest, for each of some outputs.

    He keeps the rules of switching, and holds his choices over a step. In continuous time, contact
    is made and lost at the ends of steps only. The rows of the force are those of the environments.
    A ValueError if modes are of different sizes or are ends of a constant parameter, if nothing
    disturbs, or if the rules are too fine for a grid.
    """
    if not system.is_uniform or system.has_constants:
        raise ValueError("modes differ in size, or are ends of a constant parameter")
    if system.clock is not None and not system.switching.is_arbitrary:
        raise ValueError("modes take turns, and are ruled besides")
    if not system.channels:
        raise ValueError("nothing disturbs the loop, so from rest it stays at rest")
    if not any(any(map(any, column.numerators)) for c in system.channels for column in c.columns):
        raise ValueError("what disturbs the loop acts on none of its modes")
    games = _games(system)
    return tuple(_worst(games, output, environments) for output in outputs)


def worst_against(system: SwitchedSystem, bound: Bound) -> WorstRun:
    """Let an adversary try to reach a bound.

    A bound holds however modes follow each other, and so he need keep no rules of switching.
    """
    free = replace(system, switching=ARBITRARY, clock=None, channels=tuple(bound.channels))
    return _worst(_games(free), bound.output)


def output_values(system: SwitchedSystem, output: Output, states: Array) -> Array:
    """Return an output along a run for every row of it; shape (K + 1, r).

    Tissue that can be lost pushes and never pulls.
    """
    rows = np.array([row.floats()[0] for row in output.rows])
    if system.contact is None:
        return np.asarray(states @ rows.T)
    values = np.asarray(deflected(states) @ rows.T)
    return np.maximum(values, 0.0) if pushes_only(system, output) else values


def pushes_only(system: SwitchedSystem, output: Output) -> bool:
    """Tell whether an output is of tissue that can be lost: it pushes and never pulls."""
    return system.contact is not None and output.name in ("force", DEFLECTION)


def _games(system: SwitchedSystem) -> list[_Game]:
    """Return the game on a grid that resolves the fastest motion, and on one for the slowest.

    The latter alone says nothing of the former, nor where contact is made and lost.
    """
    steps = [fine_step(system)]
    if system.time is Time.CONTINUOUS and system.contact is None:
        steps.append(max(steps[0], _length(system) / _HORIZON))
    return [_Game.create(system, step) for step in dict.fromkeys(steps)]


def _worst(
    games: Sequence[_Game], output: Output, environments: Sequence[Environment] = ()
) -> WorstRun:
    return max((game.worst(output, environments) for game in games), key=lambda run: run.value)


@dataclass(frozen=True, eq=False)
class _Run:
    """Choices of S runs, and where they begin."""

    actions: Indices  # Shape (K, S). Of `Rules`, one for each step.
    shares: Array  # Shape (K, S, c). Of the largest disturbances, from -1 to 1.
    state: Array  # Shape (S, n). At first.
    node: Indices  # Shape (S,). Of `Rules`, at first.

    def select(self, runs: Indices) -> _Run:
        """Return some of the runs."""
        return _Run(self.actions[:, runs], self.shares[:, runs], self.state[runs], self.node[runs])


@dataclass(frozen=True, eq=False)
class _Aim:
    """What is to become large at the end of a run."""

    rows: Array  # Shape (r, n), over the state
    relevant: NDArray[np.bool_]  # Shape (m, r). Which of them apply in each mode.
    one_sided: bool  # Positive values alone count, and those without contact not at all

    def sizes(self, states: Array, modes: Indices) -> Array:
        """Return the size of every row at states (..., n) in modes (...); shape (..., r)."""
        values = states @ self.rows.T
        values = values if self.one_sided else np.abs(values)
        return np.where(self.relevant[modes], values, -np.inf)


@dataclass(frozen=True, eq=False)
class _Game:
    """A loop on a grid of time."""

    system: SwitchedSystem
    step: float
    rules: Rules
    # Shape (m, n, n + c). Step of each contact mode, from state and fractions of disturbances.
    maps: Array
    flights: Array  # The same without contact; empty where contact is kept

    @classmethod
    def create(cls, system: SwitchedSystem, step: float) -> _Game:
        """Lay a system of modes of one size on a grid of time, in floating point."""
        step = fitting_step(system, step)
        parts = [np.array(mode_matrices(all_modes(system)))]
        for channel in system.channels:
            columns = np.array([column.floats() for column in channel.columns])
            parts.append(columns * float(channel.bound))
        maps = np.concatenate(parts, axis=2)
        if system.time is Time.CONTINUOUS:
            square = np.zeros((len(maps), maps.shape[2], maps.shape[2]))
            square[:, : system.order] = maps * step
            maps = expm(square)[:, : system.order]
        touching, flying = maps[: len(system.modes)], maps[len(system.modes) :]
        flights = flying[_free_counterparts(system)] if len(flying) else flying
        return cls(system, step, Rules.create(system, step), touching, flights)

    def flies(self, states: Array) -> NDArray[np.bool_]:
        """Tell at which states, shape (..., n), nothing is touched; shape (...)."""
        contact = self.system.contact
        if contact is None:
            return np.zeros(states.shape[:-1], dtype=np.bool_)
        separated = states[..., -1] <= 0
        if contact.pulls:
            # A positive force of tissue that could pull keeps contact.
            forces = states @ np.array([row.floats()[0] for row in contact.pulls]).T
            separated |= (forces <= 0).all(axis=-1)
        return np.asarray(separated)

    def _play(self, run: _Run) -> Array:
        """Simulate runs; shape (K + 1, S, n), at a switch before the reset."""
        states, rules = [run.state], self.rules
        for action, share in zip(run.actions, run.shares, strict=True):
            x = (rules.jumps[rules.jump[action]] @ states[-1][:, :, None])[:, :, 0]
            full, flies = np.concatenate([x, share], axis=1)[:, :, None], self.flies(x)
            maps = self.maps[rules.mode[action]]
            maps[flies] = self.flights[rules.mode[action[flies]]]
            states.append((maps @ full)[:, :, 0])
        return np.array(states)

    @cached_property
    def _steady(self) -> tuple[_Run, Array]:
        """The largest disturbances, held in either direction, in one mode for each run.

        Every mode of the game may follow every mode. They come after as many steps at rest as are
        chosen anew; where modes may follow each other freely, some begin where they settle.
        """
        rules, length = self.rules, int(min(_length(self.system) / self.step, _LONGEST_HOLD))
        steps = self._horizon + length
        starts = [
            (mode, sign, state)
            for mode in range(len(self.maps))
            for sign in (1.0, -1.0)
            for state in (np.zeros(self.system.order), *self._settled(mode, sign))
        ]
        targets, signs, state = map(np.array, zip(*starts, strict=True))
        actions, node = [], np.zeros_like(targets)
        for _ in range(steps):
            choices = rules.choices[node]
            best = (rules.mode[choices] == targets[:, None]).argmax(axis=1)
            actions.append(choices[np.arange(len(node)), best])
            node = rules.target[actions[-1]]
        shares = np.ones((steps, 1, self.maps.shape[2] - self.system.order)) * signs[:, None]
        shares[: self._horizon, ~state.any(axis=1)] = 0.0
        run = _Run(np.array(actions), shares, state, np.zeros_like(targets))
        return run, self._play(run)

    @cached_property
    def _horizon(self) -> int:
        return int(np.clip(_length(self.system) / self.step, 100, _HORIZON))

    def _settled(self, mode: int, sign: float) -> Iterator[Array]:
        """Yield the states that a mode settles at, in contact and on the way to the surface."""
        n = self.system.order
        if not _is_free(self.system):
            return
        A, b = self.maps[mode, :, :n], sign * self.maps[mode, :, n:].sum(axis=1)
        if _settles(A):
            state = np.linalg.solve(np.eye(n) - A, b)
            if not self.flies(state):
                yield state
        if not len(self.flights):
            return
        # The deflection, which is the last state, moves on; the others do not feel it.
        A, b = self.flights[mode, :, :n], sign * self.flights[mode, :, n:].sum(axis=1)
        if _settles(A[:-1, :-1]) and not A[:-1, -1].any():
            state = np.append(np.linalg.solve(np.eye(n - 1) - A[:-1, :-1], b[:-1]), 0.0)
            if (way := float(A[-1] @ state + b[-1])) > 0:
                state[-1] = -way * self._horizon
                yield state

    def worst(self, output: Output, environments: Sequence[Environment]) -> WorstRun:
        """Improve the last steps before held runs are at their largest; return the worst."""
        aim, (steady, states), horizon = (
            self._aim(output, environments),
            self._steady,
            self._horizon,
        )
        sizes = self._sizes(aim, states[1:], steady.actions)[horizon - 1 :]
        best = np.argsort(-sizes.max(axis=0), kind="stable")[:_CANDIDATES]
        first, rows = sizes[:, best].argmax(axis=0), np.arange(horizon)[:, None]
        previous = self.rules.target[steady.actions[first - 1, best]]
        last = _Run(
            steady.actions[first + rows, best],
            steady.shares[first + rows, best],
            states[first, best],
            np.where(first > 0, previous, steady.node[best]),
        )
        values, last = self._improve(aim, last)
        k = int(values.argmax())
        start, run = slice(first[k]), steady.select(best[[k]])
        actions = np.concatenate([run.actions[start], last.actions[:, [k]]])
        shares = np.concatenate([run.shares[start], last.shares[:, [k]]])
        return self._record(output, float(values[k]), replace(run, actions=actions, shares=shares))

    def _record(self, output: Output, value: float, run: _Run) -> WorstRun:
        system = self.system
        if _is_free(system) and not run.state.any():
            # The run begins with the first disturbance.
            start = int(run.shares.any(axis=(1, 2)).argmax())
            run = replace(run, actions=run.actions[start:], shares=run.shares[start:])
        states = self._play(run)[:, 0]
        mode = self.rules.mode[run.actions[:, 0]]
        flies = self.flies(states[:-1])
        if flies.any():
            mode = np.where(flies, len(system.modes) + _free_counterparts(system)[mode], mode)
        bounds = np.array([float(channel.bound) for channel in system.channels])
        unit = self.step if system.sample_time is None else float(system.sample_time)
        time = np.asarray(unit * np.arange(len(states)), dtype=float)
        return WorstRun(output, value, time, states, mode, run.shares[:, 0] * bounds)

    def _sizes(self, aim: _Aim, states: Array, actions: Indices) -> Array:
        """Return the size of the aim at states, shape (..., n), after actions, shape (...)."""
        size = aim.sizes(states, self.rules.mode[actions]).max(axis=-1)
        return np.where(self.flies(states), 0.0, size) if aim.one_sided else np.asarray(size)

    def _improve(self, aim: _Aim, run: _Run) -> tuple[Array, _Run]:
        """Improve runs until a sweep gains nothing, or there have been enough."""
        states, runs = self._play(run), np.arange(len(run.node))
        values = self._sizes(aim, states[-1], run.actions[-1])
        for _ in range(_SWEEPS):
            fresh = self._best_responses(aim, run, states)
            trajectories = self._play(fresh)
            sizes = self._sizes(aim, trajectories[-1], fresh.actions[-1])
            best = sizes.reshape(-1, len(runs)).argmax(axis=0) * len(runs) + runs
            gains = sizes[best] > values * (1 + _NO_GAIN)
            if not gains.any():
                break
            better = best[gains]
            run.actions[:, gains] = fresh.actions[:, better]
            run.shares[:, gains] = fresh.shares[:, better]
            states[:, gains], values[gains] = trajectories[:, better], sizes[better]
        return values, run

    def _best_responses(self, aim: _Aim, run: _Run, states: Array) -> _Run:
        """Go backward along runs with the gradient at every node; follow it from each cut on."""
        rules, n, (steps, runs) = self.rules, self.system.order, run.actions.shape
        nodes, column = len(rules.choices), np.arange(runs)
        actions = np.zeros((steps, nodes, runs), dtype=np.int32)
        signs = np.zeros((steps, nodes, runs, run.shares.shape[2]), dtype=np.int8)
        # The value of a run at a node is p x + c; every action into a node has its mode, but for a
        # single node, which has every mode and every row.
        p, c = np.zeros((nodes, runs, n)), np.zeros((nodes, runs))
        modes = np.arange(len(self.maps))
        best = aim.sizes(states[-1], np.tile(modes[:, None], runs)).argmax(axis=2)
        factors = 1.0 if aim.one_sided else np.where(states[-1] @ aim.rows.T < 0, -1.0, 1.0)
        signed = aim.rows * np.broadcast_to(factors, (runs, len(aim.rows)))[:, :, None]
        p[rules.target] = signed[column, best[rules.mode]]
        for k in range(steps - 1, -1, -1):
            x = (rules.jumps[:, None] @ states[k][:, :, None])[rules.jump, :, :, 0]
            gradients = p[rules.target] @ self.maps[rules.mode]
            if len(self.flights):
                flights = p[rules.target] @ self.flights[rules.mode]
                gradients = np.where(self.flies(x)[..., None], flights, gradients)
            constants = np.abs(gradients[:, :, n:]).sum(axis=2) + c[rules.target]
            worth = (gradients[:, :, :n] * x).sum(axis=2) + constants
            action = rules.choices[np.arange(nodes)[:, None], worth[rules.choices].argmax(axis=1)]
            gradient, c = gradients[action, column], constants[action, column]
            actions[k], signs[k] = action, np.where(gradient[:, :, n:] < 0, -1, 1)
            p = (gradient[:, :, None, :n] @ rules.jumps[rules.jump[action]])[:, :, 0]
        cuts = (np.array(_CUTS if len(self.flights) else _CUTS[:1]) * steps).astype(int)
        column = np.tile(column, len(cuts))
        fresh, first = run.select(column), np.repeat(cuts, runs)
        node = fresh.node
        for k in range(steps):
            new = k >= first
            fresh.actions[k][new] = actions[k, node, column][new]
            fresh.shares[k][new] = signs[k, node, column][new]
            node = rules.target[fresh.actions[k]]
        return fresh

    def _aim(self, output: Output, environments: Sequence[Environment]) -> _Aim:
        rows = np.array([row.floats()[0] for row in output.rows])
        relevant = np.ones((len(self.maps), len(rows)), dtype=np.bool_)
        # Under free switching, any mode may take over at the very end.
        if output.name == "force" and environments and not _is_free(self.system):
            relevant = _forces_by_mode(self.system, environments)
        return _Aim(rows, relevant, pushes_only(self.system, output))


def _forces_by_mode(system: SwitchedSystem, touched: Sequence[Environment]) -> NDArray[np.bool_]:
    """Return the rows of the force that apply to contact and corner of each mode; shape (m, r).

    Modes are named after controller, contact and corner; one that names no contact may have any.
    """
    labels = [
        {environment.name, *(f"{p}-{end}" for p, end in zip(names, ends, strict=True) if end)}
        for environment in touched
        for names in (environment.law.parameters(),)
        for ends in product(*([end for end, _ in r.ends] for r in environment.ranges))
    ]
    found = np.array(
        [[label <= set(mode.name.split("/")) for label in labels] for mode in system.modes]
    )
    return np.asarray(found | ~found.any(axis=1, keepdims=True))


def _free_counterparts(system: SwitchedSystem) -> Indices:
    """Return the free mode of each mode after a loss of contact; shape (m,).

    It has the same controller, gains, motor and delay: the name with most parts in common.
    """
    assert system.contact is not None
    touching, free = ([m.name.split("/") for m in ms] for ms in (system.modes, system.contact.free))
    common = [[(b[0] == a[0], len({*a} & {*b})) for b in free] for a in touching]
    return np.array([own.index(max(own)) for own in common], dtype=np.int64)


def _settles(A: Array) -> bool:
    return not A.size or bool(np.abs(np.linalg.eigvals(A)).max() < _SETTLES)


def _is_free(system: SwitchedSystem) -> bool:
    """Tell whether any mode may follow any mode at any time."""
    return system.switching.is_arbitrary and system.clock is None


def _length(system: SwitchedSystem) -> float:
    """Return how long the slowest motion takes to fade to a thousandth, in s or steps."""
    values = [v[np.abs(v) > 0] for v in mode_eigenvalues(system)]
    discrete = system.time is Time.DISCRETE
    rates = [-float((np.log(np.abs(v)) if discrete else v.real).max()) for v in values if len(v)]
    return _FADED / min((rate for rate in rates if rate > 0), default=_FADED / _LONGEST_HOLD)
