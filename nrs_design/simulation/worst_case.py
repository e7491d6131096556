"""The worst run that an adversary finds, for each quantity that has a limit.

It is a run that may happen, so the largest value that may occur is at least as large; a certified
bound says that it is at most so large. What is found is no bound.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.channels import Output
from nrs_design.proof.evidence.abstract import Bound
from nrs_design.proof.mode import Time
from nrs_design.proof.switching import ARBITRARY
from nrs_design.proof.system import SwitchedSystem
from nrs_design.simulation.adversary import held_signals, improve, settled_signals
from nrs_design.simulation.game import Aim, Game, Signals, free_counterparts, play
from nrs_design.simulation.norms import Array, Indices
from nrs_design.simulation.rules import fitting_step
from nrs_design.simulation.switched import fine_step, mode_eigenvalues
from nrs_design.simulation.worst_outputs import pushes_only

# Most sweeps; steps that are improved, of the held runs that come farthest.
_SWEEPS, _FEWEST, _MOST, _KEPT = 15, 100, 600, 8
# A run is held as long as a motion of the slowest mode needs to fade to a thousandth.
_FADED, _LONGEST = 8.0, 3000
_ALIKE = 1e-9


@dataclass(frozen=True, eq=False)
class WorstRun:
    """The worst run that was found for one quantity."""

    output: Output  # What was made large
    value: float  # Its size at the end of the run
    time: Array  # Shape (K + 1,). In s.
    # Shape (K + 1, n). From rest, or settled under disturbances that were held for long.
    states: Array
    mode: Indices  # Shape (K,). Mode of each step; free modes come after those in contact.
    disturbances: Array  # Shape (K, c). Held over each step, in the units of the channels.


def worst_runs(
    system: SwitchedSystem, outputs: Sequence[Output], allowed: Mapping[str, NDArray[np.bool_]]
) -> tuple[WorstRun, ...]:
    """Let an adversary choose modes and disturbances from rest, for each of some outputs.

    He keeps the rules of switching, and holds his choices over a step. In continuous time, contact
    is made and lost at the ends of steps only. `allowed` tells which rows of an output, shape
    (m, r), apply in which mode. A ValueError if modes are of different sizes or are ends of a
    constant parameter, if nothing disturbs, or if the rules are too fine for a grid.
    """
    _check(system)
    searches = [_Search.of(system, step, settled=_is_free(system)) for step in _steps(system)]
    return tuple(_worst(searches, output, _aim(system, output, allowed)) for output in outputs)


def worst_against(system: SwitchedSystem, bound: Bound) -> WorstRun:
    """Let an adversary try to reach a bound, from rest.

    A bound holds however modes follow each other, and so he need keep no rules of switching.
    """
    free = replace(system, switching=ARBITRARY, clock=None, channels=tuple(bound.channels))
    searches = [_Search.of(free, step, settled=False) for step in _steps(free)]
    return _worst(searches, bound.output, _aim(free, bound.output, {}))


def _worst(searches: Sequence[_Search], output: Output, aim: Aim) -> WorstRun:
    runs = [search.worst(output, aim, *begin) for search in searches for begin in search.begins]
    return max(runs, key=lambda run: run.value)


@dataclass(frozen=True, eq=False)
class _Search:
    """A system on a grid of time, and held runs on it with their states."""

    system: SwitchedSystem
    step: float
    game: Game
    begins: tuple[tuple[Signals, Array], ...]
    steps: int  # Steps that are improved, before the held ones

    @classmethod
    def of(cls, system: SwitchedSystem, step: float, *, settled: bool) -> _Search:
        game, length = Game.of(system, system.channels, step), _length(system) / step
        steps, held = (int(np.clip(length, _FEWEST, most)) for most in (_MOST, _LONGEST))
        begins = [held_signals(game, steps, held)]
        if settled:
            begins.append(settled_signals(game, steps, held))
        played = tuple((begin, play(game, begin)) for begin in begins if begin.nodes.size)
        return cls(system, step, game, played, steps)

    def worst(self, output: Output, aim: Aim, begin: Signals, states: Array) -> WorstRun:
        """Improve the steps before each held run is at its largest; return the worst of these."""
        game, steps = self.game, self.steps
        sizes = _sizes(game, aim, begin, states)[steps - 1 :]
        kept = np.argsort(-sizes.max(axis=0), kind="stable")[:_KEPT]
        begin, first = begin.only(kept), sizes[:, kept].argmax(axis=0)
        found = improve(game, aim, begin.spans(game, states[:, kept], first, steps), _SWEEPS)
        sizes = _sizes(game, aim, found, play(game, found))
        run = int(sizes.max(axis=0).argmax())
        # The run ends with the last of equal maxima.
        last = int(np.flatnonzero(sizes[:, run] >= (1 - _ALIKE) * sizes[:, run].max())[-1])
        before, after = slice(first[run]), slice(last + 1)
        worst = Signals(
            np.concatenate([begin.actions[before, [run]], found.actions[after, [run]]]),
            np.concatenate([begin.shares[before, [run]], found.shares[after, [run]]]),
            begin.states[[run]],
            begin.nodes[[run]],
        )
        return self._run(output, worst, float(sizes[last, run]))

    def _run(self, output: Output, signals: Signals, value: float) -> WorstRun:
        """Return one run, without the time in which it rests before any mode counts."""
        system, game, shares = self.system, self.game, signals.shares[:, 0]
        states, actions = play(game, signals)[:, 0], signals.actions[:, 0]
        if _is_free(system) and not states[0].any():
            begun = int(shares.any(axis=1).argmax())
            states, actions, shares = states[begun:], actions[begun:], shares[begun:]
        mode = game.rules.mode[actions]
        if system.contact is not None:
            flies = game.flies(states[:-1])
            mode = np.where(flies, len(system.modes) + free_counterparts(system)[mode], mode)
        bounds = np.array([float(channel.bound) for channel in system.channels])
        unit = self.step if system.sample_time is None else float(system.sample_time)
        time = np.asarray(unit * np.arange(len(states)), dtype=float)
        return WorstRun(output, value, time, states, mode, shares * bounds)


def _sizes(game: Game, aim: Aim, signals: Signals, states: Array) -> Array:
    """Return what is wanted after every step; shape (K, S)."""
    modes = game.rules.mode[signals.actions]
    pairs = zip(states[1:], modes, strict=True)
    return np.array([aim.values(game, after, mode)[0] for after, mode in pairs])


def _is_free(system: SwitchedSystem) -> bool:
    """Tell whether any mode may follow any mode at any time."""
    return system.switching.is_arbitrary and system.clock is None


def _check(system: SwitchedSystem) -> None:
    if not system.is_uniform or system.has_constants:
        raise ValueError("modes differ in size, or are ends of a constant parameter")
    if system.clock is not None and not system.switching.is_arbitrary:
        raise ValueError("modes take turns, and are ruled besides")
    if not system.channels:
        raise ValueError("nothing disturbs the loop, so from rest it stays at rest")
    if not any(any(map(any, column.numerators)) for c in system.channels for column in c.columns):
        raise ValueError("what disturbs the loop acts on none of its modes")


def _length(system: SwitchedSystem) -> float:
    """Return how long the slowest motion takes to fade to a thousandth, in s or steps."""
    values = [v[np.abs(v) > 0] for v in mode_eigenvalues(system)]
    discrete = system.time is Time.DISCRETE
    rates = [-float((np.log(np.abs(v)) if discrete else v.real).max()) for v in values if len(v)]
    return _FADED / min((rate for rate in rates if rate > 0), default=_FADED / _LONGEST)


def _steps(system: SwitchedSystem) -> list[float]:
    """Return steps in time: one that resolves the fastest motion, and one for the slowest.

    The latter alone says nothing of the former, nor where contact is made and lost.
    """
    fine = fine_step(system)
    if system.time is Time.DISCRETE or system.contact is not None:
        return [fitting_step(system, fine)]
    coarse = max(fine, _length(system) / _MOST)
    return [fitting_step(system, step) for step in dict.fromkeys((fine, coarse))]


def _aim(system: SwitchedSystem, output: Output, allowed: Mapping[str, NDArray[np.bool_]]) -> Aim:
    rows = np.array([row.floats()[0] for row in output.rows])
    # Under free switching, any mode may take over at the very end.
    given = None if _is_free(system) else allowed.get(output.name)
    every = np.ones((len(system.modes), len(rows)), dtype=np.bool_)
    return Aim(rows, every if given is None else given, pushes_only(system, output))
