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
from nrs_design.simulation.switched import all_modes, expm, fine_step, mode_eigenvalues

# Steps that are chosen anew, of so many of the runs that come farthest while a choice is held, for
# so many steps; most sweeps.
_CHOSEN, _KEPT, _HELD, _SWEEPS = 600, 8, 3000, 15
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
    """The worst run found for one quantity."""

    output: Output  # The quantity
    value: float  # Its size at the end of the run
    time: Array  # Shape (K + 1,). In s.
    # Shape (K + 1, n). From rest, or settled under disturbances that were held for long.
    states: Array
    mode: Indices  # Shape (K,). Mode of each step; free modes come after those in contact.
    disturbances: Array  # Shape (K, c). Held over each step, in the units of the channels.


def worst_runs(
    system: SwitchedSystem, outputs: Sequence[Output], touched: Sequence[Environment] = ()
) -> tuple[WorstRun, ...]:
    """Let an adversary choose modes and disturbances from rest, for each of some outputs.

    He keeps the rules of switching, and holds his choices over a step. In continuous time, contact
    is made and lost at the ends of steps only. The rows of the force are those of what is touched.
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
    each = ([game.worst(output, touched) for game in games] for output in outputs)
    return tuple(max(found, key=lambda run: run.value) for found in each)


def worst_against(system: SwitchedSystem, bound: Bound) -> WorstRun:
    """Let an adversary try to reach a bound.

    A bound holds however modes follow each other, and so he need keep no rules of switching.
    """
    free = replace(system, switching=ARBITRARY, clock=None, channels=tuple(bound.channels))
    return max((game.worst(bound.output) for game in _games(free)), key=lambda run: run.value)


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
        steps.append(max(steps[0], _length(system) / _CHOSEN))
    return [_Game.of(system, step) for step in dict.fromkeys(steps)]


@dataclass(frozen=True, eq=False)
class _Run:
    """Choices of S runs, and where they begin."""

    actions: Indices  # Shape (K, S). Of `Rules`, one for each step.
    shares: Array  # Shape (K, S, c). Of the largest disturbances, from -1 to 1.
    state: Array  # Shape (S, n). At first.
    node: Indices  # Shape (S,). Of `Rules`, at first.

    def only(self, runs: Indices) -> _Run:
        """Return some of the runs."""
        return _Run(self.actions[:, runs], self.shares[:, runs], self.state[runs], self.node[runs])


@dataclass(frozen=True, eq=False)
class _Aim:
    """What is to become large at the end of a run."""

    rows: Array  # Shape (r, n), over the state
    allowed: NDArray[np.bool_]  # Shape (m, r). Which of them apply in each mode.
    one_sided: bool  # Positive values alone count, and those without contact not at all

    def sizes(self, states: Array, modes: Indices) -> Array:
        """Return the size of every row at states (..., n) in modes (...); shape (..., r)."""
        found = states @ self.rows.T
        found = found if self.one_sided else np.abs(found)
        return np.where(self.allowed[modes], found, -np.inf)


@dataclass(frozen=True, eq=False)
class _Game:
    """A loop on a grid of time."""

    system: SwitchedSystem
    step: float
    rules: Rules
    # Shape (m, n, n + c). Step of each mode in contact, from state and fractions of disturbances;
    # and the same without contact, which is empty where contact is kept.
    maps: Array
    flights: Array

    @classmethod
    def of(cls, system: SwitchedSystem, step: float) -> _Game:
        """Lay a system of modes of one size on a grid of time, in floating point."""
        step = fitting_step(system, step)
        parts = [np.array([mode.A.floats() for mode in all_modes(system).modes])]
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
        return cls(system, step, Rules.of(system, step), touching, flights)

    @property
    def losable(self) -> bool:
        """Whether contact may be lost."""
        return self.system.contact is not None

    @cached_property
    def _pulls(self) -> Array | None:
        """Forces of tissue that could pull, shape (q, n); contact is kept by a positive one."""
        contact = self.system.contact
        rows = () if contact is None else contact.pulls
        return np.array([row.floats()[0] for row in rows]) if rows else None

    def flies(self, states: Array) -> NDArray[np.bool_]:
        """Tell at which states, shape (..., n), nothing is touched; shape (...)."""
        if not self.losable:
            return np.zeros(states.shape[:-1], dtype=np.bool_)
        lost = states[..., -1] <= 0
        if self._pulls is not None:
            lost |= (states @ self._pulls.T <= 0).all(axis=-1)
        return np.asarray(lost)

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
    def held(self) -> tuple[_Run, Array]:
        """The largest disturbances, held in either direction, in one mode for each run.

        Every mode of the game may follow every mode. They come after as many steps at rest as are
        chosen anew; where modes may follow each other freely, some begin where they settle.
        """
        rules, steps = self.rules, self._chosen + int(min(_length(self.system) / self.step, _HELD))
        begins = [
            (mode, sign, state)
            for mode in range(len(self.maps))
            for sign in (1.0, -1.0)
            for state in (np.zeros(self.system.order), *self._settled(mode, sign))
        ]
        wanted = np.array([mode for mode, _, _ in begins])
        state = np.array([state for _, _, state in begins])
        actions, node = [], np.zeros_like(wanted)
        for _ in range(steps):
            choices = rules.choices[node]
            best = (rules.mode[choices] == wanted[:, None]).argmax(axis=1)
            actions.append(choices[np.arange(len(node)), best])
            node = rules.target[actions[-1]]
        shares = np.ones((steps, 1, self.maps.shape[2] - self.system.order))
        shares = shares * np.array([sign for _, sign, _ in begins])[:, None]
        shares[: self._chosen, ~state.any(axis=1)] = 0.0
        run = _Run(np.array(actions), shares, state, np.zeros_like(wanted))
        return run, self._play(run)

    @cached_property
    def _chosen(self) -> int:
        return int(np.clip(_length(self.system) / self.step, 100, _CHOSEN))

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
        if not self.losable:
            return
        # The deflection, which is the last state, moves on; the others do not feel it.
        A, b = self.flights[mode, :, :n], sign * self.flights[mode, :, n:].sum(axis=1)
        if _settles(A[:-1, :-1]) and not A[:-1, -1].any():
            state = np.append(np.linalg.solve(np.eye(n - 1) - A[:-1, :-1], b[:-1]), 0.0)
            if (way := float(A[-1] @ state + b[-1])) > 0:
                state[-1] = -way * self._chosen
                yield state

    def worst(self, output: Output, touched: Sequence[Environment] = ()) -> WorstRun:
        """Improve the last steps before held runs are at their largest; return the worst."""
        aim, (held, states), target = self._aim(output, touched), self.held, self.rules.target
        sizes = self._sizes(aim, states[1:], self.rules.mode[held.actions])[self._chosen - 1 :]
        kept = np.argsort(-sizes.max(axis=0), kind="stable")[:_KEPT]
        first, rows = sizes[:, kept].argmax(axis=0), np.arange(self._chosen)[:, None]
        node = np.where(first > 0, target[held.actions[first - 1, kept]], held.node[kept])
        last = _Run(
            held.actions[first + rows, kept],
            held.shares[first + rows, kept],
            states[first, kept],
            node,
        )
        values, last = self._improved(aim, last)
        best = int(values.argmax())
        before, one = slice(first[best]), held.only(kept[[best]])
        actions = np.concatenate([one.actions[before], last.actions[:, [best]]])
        shares = np.concatenate([one.shares[before], last.shares[:, [best]]])
        run = replace(one, actions=actions, shares=shares)
        return self._shown(output, float(values[best]), run)

    def _shown(self, output: Output, value: float, run: _Run) -> WorstRun:
        system = self.system
        if _is_free(system) and not run.state.any():
            # The run begins with the first disturbance.
            begun = int(run.shares.any(axis=(1, 2)).argmax())
            run = replace(run, actions=run.actions[begun:], shares=run.shares[begun:])
        states = self._play(run)[:, 0]
        mode = self.rules.mode[run.actions[:, 0]]
        flies = self.flies(states[:-1])
        if flies.any():
            mode = np.where(flies, len(system.modes) + _free_counterparts(system)[mode], mode)
        bounds = np.array([float(channel.bound) for channel in system.channels])
        unit = self.step if system.sample_time is None else float(system.sample_time)
        time = np.asarray(unit * np.arange(len(states)), dtype=float)
        return WorstRun(output, value, time, states, mode, run.shares[:, 0] * bounds)

    def _sizes(self, aim: _Aim, states: Array, modes: Indices) -> Array:
        """Return the size of the aim at states, shape (..., n), in modes, shape (...)."""
        size = aim.sizes(states, modes).max(axis=-1)
        return np.where(self.flies(states), 0.0, size) if aim.one_sided else np.asarray(size)

    def _improved(self, aim: _Aim, run: _Run) -> tuple[Array, _Run]:
        """Improve runs until a sweep gains nothing, or there have been enough."""
        states, runs = self._play(run), np.arange(len(run.node))
        values = self._sizes(aim, states[-1], self.rules.mode[run.actions[-1]])
        for _ in range(_SWEEPS):
            fresh = self._answers(aim, run, states)
            reached = self._play(fresh)
            sizes = self._sizes(aim, reached[-1], self.rules.mode[fresh.actions[-1]])
            picked = sizes.reshape(-1, len(runs)).argmax(axis=0) * len(runs) + runs
            gained = sizes[picked] > values * (1 + _NO_GAIN)
            if not gained.any():
                break
            better = picked[gained]
            run.actions[:, gained] = fresh.actions[:, better]
            run.shares[:, gained] = fresh.shares[:, better]
            states[:, gained], values[gained] = reached[:, better], sizes[better]
        return values, run

    def _answers(self, aim: _Aim, run: _Run, states: Array) -> _Run:
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
        turned = 1.0 if aim.one_sided else np.where(states[-1] @ aim.rows.T < 0, -1.0, 1.0)
        signed = aim.rows * np.broadcast_to(turned, (runs, len(aim.rows)))[:, :, None]
        p[rules.target] = signed[column, best[rules.mode]]
        for k in range(steps - 1, -1, -1):
            x = (rules.jumps[:, None] @ states[k][:, :, None])[rules.jump, :, :, 0]
            pulled = p[rules.target] @ self.maps[rules.mode]
            if self.losable:
                lost = self.flies(x)[..., None]
                pulled = np.where(lost, p[rules.target] @ self.flights[rules.mode], pulled)
            added = np.abs(pulled[:, :, n:]).sum(axis=2) + c[rules.target]
            worth = (pulled[:, :, :n] * x).sum(axis=2) + added
            action = rules.choices[np.arange(nodes)[:, None], worth[rules.choices].argmax(axis=1)]
            own, c = pulled[action, column], added[action, column]
            actions[k], signs[k] = action, np.where(own[:, :, n:] < 0, -1, 1)
            p = (own[:, :, None, :n] @ rules.jumps[rules.jump[action]])[:, :, 0]
        cuts = (np.array(_CUTS if self.losable else _CUTS[:1]) * steps).astype(int)
        column = np.tile(column, len(cuts))
        fresh, first = run.only(column), np.repeat(cuts, runs)
        node = fresh.node
        for k in range(steps):
            new = k >= first
            fresh.actions[k][new] = actions[k, node, column][new]
            fresh.shares[k][new] = signs[k, node, column][new]
            node = rules.target[fresh.actions[k]]
        return fresh

    def _aim(self, output: Output, touched: Sequence[Environment]) -> _Aim:
        rows = np.array([row.floats()[0] for row in output.rows])
        allowed = np.ones((len(self.maps), len(rows)), dtype=np.bool_)
        # Under free switching, any mode may take over at the very end.
        if output.name == "force" and touched and not _is_free(self.system):
            allowed = _forces_by_mode(self.system, touched)
        return _Aim(rows, allowed, pushes_only(self.system, output))


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
    return _FADED / min((rate for rate in rates if rate > 0), default=_FADED / _HELD)
