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
    grids = [_Grid.of(system, wanted, steps) for wanted, steps in _grids(system)]
    return tuple(
        max(
            (_found(system, grid, output, allowed, (seed, starts, rounds)) for grid in grids),
            key=lambda run: run.value,
        )
        for output in outputs
    )


@dataclass(frozen=True, eq=False)
class _Grid:
    """A system on a grid of time, with a finer one for the end where choices are free."""

    step: float
    steps: int
    game: Game
    fine: Game | None

    @classmethod
    def of(cls, system: SwitchedSystem, wanted: float, steps: int) -> _Grid:
        step = fitting_step(system, wanted)
        fine = None
        if system.time is Time.CONTINUOUS and _is_free(system):
            fine = Game.of(system, system.channels, step / _FINER)
        return cls(step, steps, Game.of(system, system.channels, step), fine)


def _found(
    system: SwitchedSystem,
    grid: _Grid,
    output: Output,
    allowed: Mapping[str, NDArray[np.bool_]],
    effort: tuple[int, int, int],
) -> WorstRun:
    """Search on one grid, with an effort of seed, starts and rounds."""
    seed, starts, rounds = effort
    game, aim, rng = grid.game, _aim(system, output, allowed), np.random.default_rng(seed)
    drawn = random_signals(game, grid.steps, starts, rng)
    signals, values, first = _searched(game, aim, drawn, rounds, rng)
    if _is_free(system):
        signals, values = _lengthened(game, aim, signals, values)
    step = grid.step
    if grid.fine is not None:
        step, game = step / _FINER, grid.fine
        signals, values = improve(game, aim, signals.finer(_FINER), SWEEPS)
    return _run(system, game, output, signals, step, float(values[0]), first)


def _searched(
    game: Game, aim: Aim, signals: Signals, rounds: int, rng: np.random.Generator
) -> tuple[Signals, Array, Array]:
    """Improve runs, and again what becomes of the best of them by errors; return the best.

    The value of the best, shape (1,), and what every start came to are returned besides.
    """
    signals, values = improve(game, aim, signals, SWEEPS)
    first = values
    for _ in range(rounds):
        kept = np.argsort(-values)[:_KEPT]
        best = signals.only(kept)
        changed = changed_signals(game, best, _COPIES, rng)
        misjudged = misjudged_signals(game, aim, best, _COPIES, rng)
        fresh, came = improve(game, aim, changed.beside(misjudged), SWEEPS)
        signals, values = best.beside(fresh), np.concatenate([values[kept], came])
    top = np.argsort(-values)[:1]
    return signals.only(top), values[top], first


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
    begin = held_signals(game, steps).beside(random_signals(game, steps, _DRAWN, rng))
    signals, values, first = _searched(game, aim, begin, _TURNS, rng)
    return _run(free, game, bound.output, signals, step, float(values[0]), first)


def _lengthened(game: Game, aim: Aim, signals: Signals, values: Array) -> tuple[Signals, Array]:
    """Give the best runs more time before, as long as that is worth it."""
    for _ in range(_DOUBLED):
        before = values
        signals, values = improve(game, aim, signals.longer(), SWEEPS)
        if (values <= _WORTH * before).all():
            break
    return signals, values


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
    # Under free switching, any mode may take over at the very end.
    given = None if _is_free(system) else allowed.get(output.name)
    every = np.ones((len(system.modes), len(rows)), dtype=np.bool_)
    return Aim(rows, every if given is None else given, pushes_only(system, output))


def _run(
    system: SwitchedSystem,
    game: Game,
    output: Output,
    signals: Signals,
    step: float,
    value: float,
    starts: Array,
) -> WorstRun:
    if _is_free(system):
        signals = signals.after_rest()
    states = play(game, signals)[:, 0]
    mode = game.rules.mode[signals.actions[:, 0]]
    if system.contact is not None:
        flies = game.flies(states[:-1])
        mode = np.where(flies, len(system.modes) + free_counterparts(system)[mode], mode)
    bounds = np.array([float(channel.bound) for channel in system.channels])
    unit = step if system.sample_time is None else float(system.sample_time)
    time = np.asarray(unit * np.arange(len(states)), dtype=float)
    disturbances = signals.shares[:, 0] * bounds
    return WorstRun(output, value, time, states, mode, disturbances, np.sort(starts)[::-1])
