"""A bad run: at every step the adversary takes the possible mode that makes a norm largest."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from nrs_design.proof.mode import Time
from nrs_design.proof.switching import NOWHERE
from nrs_design.proof.system import SwitchedSystem
from nrs_design.simulation.norms import Array, Indices, Norm
from nrs_design.simulation.saturation import saturated_step
from nrs_design.simulation.switched import SwitchedRun, sampling_instants, transition_matrices


def all_modes(system: SwitchedSystem) -> SwitchedSystem:
    """Return a system of all modes, in contact and in free motion."""
    if system.contact is None:
        return system
    return replace(system, modes=(*system.modes, *system.contact.free), contact=None)


def greedy_run(
    system: SwitchedSystem,
    norms: Norm | Sequence[Norm],
    initial: Array,
    step: float,
    steps: int,
) -> SwitchedRun:
    """Simulate the greedy adversary: always the possible mode after which the norm is largest.

    Modes in contact are possible while the deflection, the last state, is positive, and free modes
    while it is not; in continuous time contact changes at the end of a step only, so steps, in s,
    must be short. A mode of a clock is possible where that allows it. It is a bad run, not the
    worst one: nothing is proved by it. Norms take states of shape (..., n); with a clock, there is
    one for each of its states, and time zero begins a round, or no deadline has been missed. The
    modes of the run are those of `all_modes`.
    """
    each = [norms] if callable(norms) else list(norms)
    possible, advance = _possible(system), _advance(system, step)
    states, chosen, turns = [initial], [], [0]
    for _ in range(steps):
        kept, ahead = possible(turns[-1], states[-1])
        candidates = advance(states[-1], kept)
        values = np.empty(len(kept))
        for turn in {*ahead.tolist()}:
            values[ahead == turn] = each[turn % len(each)](candidates[ahead == turn])
        best = int(values.argmax())
        chosen.append(int(kept[best]))
        turns.append(int(ahead[best]))
        states.append(candidates[best])
    unit = 1.0 if system.time is Time.DISCRETE else step
    instants = sampling_instants(unit, steps)
    return SwitchedRun(instants, np.array(states), np.array(chosen), np.array(turns))


def relative_norms(run: SwitchedRun, norms: Norm | Sequence[Norm]) -> Array:
    """Return the norm along a run over its first value; shape (N + 1,).

    Norms as for `greedy_run`; with a clock, the run begins with a round.
    """
    if callable(norms):
        values = norms(run.state)
    else:
        assert run.turn is not None
        pairs = zip(run.turn.tolist(), run.state, strict=True)
        values = np.array([norms[turn](x) for turn, x in pairs])
    return np.asarray(values / values[0])


def _possible(system: SwitchedSystem) -> Callable[[int, Array], tuple[Indices, Indices]]:
    """Return the function from the turn and a state to the modes that may be taken.

    With each it returns the turn after it.
    """
    modes, clock = all_modes(system).modes, system.clock
    free = np.arange(len(modes)) >= len(system.modes)
    kinds = np.array([0] if clock is None else clock.kind_of(mode.name for mode in modes))

    def possible(turn: int, x: Array) -> tuple[Indices, Indices]:
        ahead = np.zeros(len(modes), dtype=np.int64)
        if clock is not None:
            for kind in clock.kinds:
                target = clock.after(turn, kind)
                ahead[kinds == kind] = NOWHERE if target is None else target
        felt = free == (free.any() and x[-1] <= 0)
        kept = np.flatnonzero(felt & (ahead != NOWHERE))
        return kept, ahead[kept]

    return possible


def _advance(system: SwitchedSystem, step: float) -> Callable[[Array, Indices], Array]:
    """Return the function from a state and modes to the states after a step in each of them."""
    if system.saturation is not None:
        return saturated_step(system, step)
    maps = transition_matrices(all_modes(system), step)
    return lambda x, modes: maps[modes] @ x
