"""The worst run from rest that an adversary finds, for each quantity that has a limit.

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
from nrs_design.simulation.adversary import (
    changed_signals,
    held_signals,
    improve,
    misjudged_signals,
    random_signals,
)
from nrs_design.simulation.game import Aim, Game, Signals, free_counterparts, play
from nrs_design.simulation.norms import Array, Indices
from nrs_design.simulation.rules import fitting_step
from nrs_design.simulation.switched import fine_step, mode_eigenvalues
from nrs_design.simulation.worst_outputs import pushes_only

# Starts for each quantity, most sweeps from each, and rounds in which the best are changed.
STARTS, SWEEPS, ROUNDS = 24, 15, 8
_KEPT, _COPIES = 4, 3
# How often the best runs are made twice as long, and by what factor that must make them worse.
_DOUBLED, _WORTH = 3, 1.01
# How much finer the grid is at last, in continuous time.
_FINER = 4
# A run is as long as a motion of the slowest mode needs to fade to a thousandth, and has so many
# steps; in continuous time they are longer where there would be more.
_FADED, _FEWEST, _MOST = 8.0, 100, 300
# How many times the rounds where contact may be lost: there, what is found depends on the starts.
_BOUNCING = 3
# How much closer the next grid is, where one does not resolve the fastest motion.
_CLOSER = 16
# Against a bound, a run is as long as its set needs to fill up to a thousandth, if steps are few.
_FILLED, _LONGEST, _DRAWN, _TURNS = 7.0, 800, 8, 6


@dataclass(frozen=True, eq=False)
class WorstRun:
    """The worst run that was found for one quantity."""

    output: Output  # What was made large
    value: float  # Its size at the end of the run
    time: Array  # Shape (K + 1,). In s.
    states: Array  # Shape (K + 1, n). From rest.
    mode: Indices  # Shape (K,). In force over each step; the free ones after those in contact.
    disturbances: Array  # Shape (K, c). Held over each step, in the units of the channels.
    starts: Array  # Shape (S,). What every start came to, the worst first.


def worst_runs(
    system: SwitchedSystem,
    outputs: Sequence[Output],
    allowed: Mapping[str, NDArray[np.bool_]],
    *,
    seed: int = 0,
    starts: int = STARTS,
    rounds: int | None = None,
) -> tuple[WorstRun, ...]:
    """Let an adversary choose modes and disturbances from rest, for each of some outputs.

    He keeps the rules of switching, holds his choices over a step, and begins from seeded starts.
    In continuous time, contact is made and lost at the ends of steps only.

    Parameters
    ----------
    system : SwitchedSystem
        Modes of one size, with disturbances and no clock.
    outputs : sequence of Output
        Of that system, or other rows over its state.
    allowed : mapping of str to ndarray of bool, shape (m, r)
        Which rows of an output apply in which mode, where switching is ruled.
    seed : int
        Of the starts.
    starts : int
        For each output.
    rounds : int, optional
        How often the best runs are changed, and improved again; by default more often where contact
        may be lost.

    Raises
    ------
    ValueError
        If modes are of different sizes or are ends of a constant parameter, if nothing disturbs, or
        if the rules are too fine for a grid.
    """
    _check(system)
    if rounds is None:
        rounds = ROUNDS if system.contact is None else ROUNDS * _BOUNCING
    found = [
        _on_grid(system, outputs, allowed, step, steps, (seed, starts, rounds))
        for step, steps in _grids(system)
    ]
    return tuple(max(runs, key=lambda run: run.value) for runs in zip(*found, strict=True))


def _on_grid(
    system: SwitchedSystem,
    outputs: Sequence[Output],
    allowed: Mapping[str, NDArray[np.bool_]],
    wanted: float,
    steps: int,
    effort: tuple[int, int, int],
) -> tuple[WorstRun, ...]:
    """Search among runs of so many steps of about this time; effort: seed, starts, rounds."""
    seed, starts, rounds = effort
    step = fitting_step(system, wanted)
    game = Game.of(system, system.channels, step)
    own = [_aim(system, output, allowed) for output in outputs]
    search = _Search(game, own, np.random.default_rng(seed))
    signals, values = search.begin(steps, starts)
    first = values
    for _ in range(rounds):
        signals, values = search.again(signals, values)
    signals, values = search.best(signals, values, 1)
    if _is_free(system):
        signals, values = _lengthened(game, _joined(own), signals, values)
    if system.time is Time.CONTINUOUS and _is_free(system):
        step /= _FINER
        game = Game.of(system, system.channels, step)
        signals, values = improve(game, _joined(own), signals.finer(_FINER), SWEEPS)
    unit = step if system.sample_time is None else float(system.sample_time)
    return tuple(
        _run(
            system, game, output, signals.only(np.array([i])), unit, values[i], np.sort(came)[::-1]
        )
        for i, (output, came) in enumerate(zip(outputs, np.split(first, len(own)), strict=True))
    )


def worst_against(system: SwitchedSystem, bound: Bound) -> WorstRun:
    """Let an adversary try to reach a bound, within seconds; `worst_runs` searches longer.

    A bound holds however modes follow each other, and so he need keep no rules of switching. He
    begins with the largest disturbances held in every mode, and with some drawn ones.

    Parameters
    ----------
    system : SwitchedSystem
        That the bound is about.
    bound : Bound
        Whose disturbances act, and whose output is to become large.
    """
    free = replace(system, switching=ARBITRARY, clock=None, channels=tuple(bound.channels))
    share, step = float(bound.share), fine_step(system)
    rate = -np.log1p(-share) if system.time is Time.DISCRETE else share
    steps = int(np.clip(_FILLED / (rate * step), _FEWEST, _LONGEST))
    game, aim = Game.of(free, bound.channels, step), _aim(free, bound.output, {})
    rng = np.random.default_rng(0)
    search = _Search(game, [aim], rng)
    drawn = random_signals(game, steps, _DRAWN, rng)
    signals, values = search.improved(held_signals(game, steps).beside(drawn))
    first = values
    for _ in range(_TURNS):
        signals, values = search.again(signals, values)
    (signals, values) = search.best(signals, values, 1)
    unit = step if system.sample_time is None else float(system.sample_time)
    return _run(free, game, bound.output, signals, unit, float(values[0]), first)


def _lengthened(game: Game, aim: Aim, signals: Signals, values: Array) -> tuple[Signals, Array]:
    """Give the best runs more time before, as long as that is worth it."""
    for _ in range(_DOUBLED):
        before = values
        signals, values = improve(game, aim, signals.longer(), SWEEPS)
        if (values <= _WORTH * before).all():
            break
    return signals, values


@dataclass(frozen=True, eq=False)
class _Search:
    """Runs for several aims at once: those of the first aim, then as many of the next."""

    game: Game
    aims: Sequence[Aim]
    rng: np.random.Generator

    def begin(self, steps: int, starts: int) -> tuple[Signals, Array]:
        """Improve random runs; what is drawn is the same for all aims."""
        count = len(self.aims)
        drawn = random_signals(self.game, steps, starts, self.rng)
        signals = Signals(np.tile(drawn.actions, count), np.tile(drawn.shares, (1, count, 1)))
        return self.improved(signals)

    def again(self, signals: Signals, values: Array) -> tuple[Signals, Array]:
        """Keep the best runs, and improve what becomes of them by some changes."""
        kept, reached = self.best(signals, values, _KEPT)
        groups = np.arange(len(reached)).reshape(len(self.aims), -1)
        parts = [
            self._children(kept.only(group), aim)
            for group, aim in zip(groups, self.aims, strict=True)
        ]
        fresh, came = self.improved(_beside(parts))
        every = kept.beside(fresh)
        # In the order of the aims again.
        mine = np.arange(len(came)).reshape(len(self.aims), -1) + len(reached)
        order = np.concatenate([groups, mine], axis=1).ravel()
        return every.only(order), np.concatenate([reached, came])[order]

    def _children(self, signals: Signals, aim: Aim) -> Signals:
        """Change what the best runs do for a while, or how they are continued."""
        runs = signals.actions.shape[1]
        own = _joined([aim] * runs)
        changed = changed_signals(self.game, signals, _COPIES, self.rng)
        return changed.beside(misjudged_signals(self.game, own, signals, _COPIES, self.rng))

    def best(self, signals: Signals, values: Array, count: int) -> tuple[Signals, Array]:
        """Return the best runs for each aim, the worst ones for the robot first."""
        parts = np.split(np.arange(len(values)), len(self.aims))
        kept = np.concatenate([part[np.argsort(-values[part])[:count]] for part in parts])
        return signals.only(kept), values[kept]

    def improved(self, signals: Signals) -> tuple[Signals, Array]:
        """Improve as many runs for each aim."""
        each = signals.actions.shape[1] // len(self.aims)
        aim = _joined([aim for aim in self.aims for _ in range(each)])
        return improve(self.game, aim, signals, SWEEPS)


def _beside(parts: Sequence[Signals]) -> Signals:
    first, *others = parts
    for other in others:
        first = first.beside(other)
    return first


def _is_free(system: SwitchedSystem) -> bool:
    """Tell whether any mode may follow any mode at any time."""
    return system.switching.is_arbitrary and system.clock is None


def _check(system: SwitchedSystem) -> None:
    if not system.is_uniform or system.switching.fixed_ends:
        raise ValueError("modes differ in size, or are ends of a constant parameter")
    if system.clock is not None and not system.switching.is_arbitrary:
        raise ValueError("modes take turns, and are ruled besides")
    if not system.channels:
        raise ValueError("nothing disturbs the loop, so from rest it stays at rest")
    if not any(any(map(any, column.numerators)) for c in system.channels for column in c.columns):
        raise ValueError("what disturbs the loop acts on none of its modes")


def _grids(system: SwitchedSystem) -> list[tuple[float, int]]:
    """Return steps in time, each with a number: the slowest motion fades in the longest ones.

    Where the fastest motion is much faster, a grid that resolves one says nothing of the other.
    """
    fine = fine_step(system)
    values = [v[np.abs(v) > 0] for v in mode_eigenvalues(system)]
    discrete = system.time is Time.DISCRETE
    rates = [-float((np.log(np.abs(v)) if discrete else v.real).max()) for v in values if len(v)]
    slowest = min((rate for rate in rates if rate > 0), default=_FADED / (fine * _MOST))
    length = _FADED / slowest
    if discrete:
        return [(fine, int(np.clip(length / fine, _FEWEST, _MOST)))]
    step = max(fine, length / _MOST)
    found = [(step, int(np.clip(length / step, _FEWEST, _MOST)))]
    while step > 2 * _FINER * fine:
        step = max(step / _CLOSER, fine)
        found.append((step, _MOST))
    return found


def _aim(system: SwitchedSystem, output: Output, allowed: Mapping[str, NDArray[np.bool_]]) -> Aim:
    rows = np.array([row.floats()[0] for row in output.rows])
    every = np.ones((len(system.modes), len(rows)), dtype=np.bool_)
    # Under free switching, any mode may take over at the very end.
    given = None if _is_free(system) else allowed.get(output.name)
    return Aim(
        rows[None],
        (every if given is None else given)[None],
        np.array([pushes_only(system, output)]),
    )


def _joined(aims: Sequence[Aim]) -> Aim:
    """Put aims of different outputs beside each other; who has fewer rows repeats the last."""
    width = max(aim.rows.shape[1] for aim in aims)

    kept = [np.minimum(np.arange(width), aim.rows.shape[1] - 1) for aim in aims]
    return Aim(
        np.concatenate([aim.rows[:, rows] for aim, rows in zip(aims, kept, strict=True)]),
        np.concatenate([aim.allowed[:, :, rows] for aim, rows in zip(aims, kept, strict=True)]),
        np.concatenate([aim.one_sided for aim in aims]),
    )


def _run(
    system: SwitchedSystem,
    game: Game,
    output: Output,
    signals: Signals,
    unit: float,
    value: float,
    starts: Array,
) -> WorstRun:
    order = np.sort(starts)[::-1]
    if _is_free(system):
        signals = signals.after_rest()
    states = play(game, signals)[:, 0]
    mode = game.rules.mode[signals.actions[:, 0]]
    if system.contact is not None:
        flies = game.flies(states[:-1])
        mode = np.where(flies, len(system.modes) + free_counterparts(system)[mode], mode)
    bounds = np.array([float(channel.bound) for channel in system.channels])
    time = np.asarray(unit * np.arange(len(states)), dtype=float)
    shares = signals.shares[:, 0]
    return WorstRun(output, float(value), time, states, mode, shares * bounds, order)
