"""Runs of modes that take turns, with an adversary who chooses among those whose turn it is."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from nrs_design.proof.contact import Contact
from nrs_design.proof.system import SwitchedSystem
from nrs_design.simulation.contact import with_free_modes
from nrs_design.simulation.norms import Array, Norm
from nrs_design.simulation.switched import SwitchedRun, sampling_instants, transition_matrices


def all_modes(system: SwitchedSystem) -> SwitchedSystem:
    """Return the modes in contact and those of free motion, if any, as one family."""
    return system if system.contact is None else with_free_modes(system)


def worst_rounds(
    system: SwitchedSystem, norms: Sequence[Norm], initial: Array, steps: int
) -> SwitchedRun:
    """Simulate the greedy adversary: always the mode after which the norm of its step is largest.

    Modes in contact are possible while the deflection is positive, and free ones while it is not.
    Nothing is proved by it.

    Parameters
    ----------
    system : SwitchedSystem
        With its clock.
    norms : sequence of callable
        One for each step of a round.
    initial : ndarray, shape (n,)
        State at time zero, where a round begins.
    steps : int
        Number of decisions N.

    Returns
    -------
    SwitchedRun
        Its modes are those of `all_modes`.
    """
    clock = system.clock
    assert clock is not None
    free = (system.contact or Contact(())).free
    maps = transition_matrices(all_modes(system), 1.0)
    begins = np.array([mode.name in clock.first for mode in (*system.modes, *free)])
    flies = np.arange(len(maps)) >= len(system.modes)
    states, chosen = [initial], list[int]()
    for t in range(steps):
        lost = bool(free) and states[-1][-1] <= 0
        kept = np.flatnonzero((begins == (t % clock.length == 0)) & (flies == lost))
        candidates = maps[kept] @ states[-1]
        best = int(norms[(t + 1) % clock.length](candidates).argmax())
        chosen.append(int(kept[best]))
        states.append(candidates[best])
    return SwitchedRun(sampling_instants(1.0, steps), np.array(states), np.array(chosen))


def norms_in_rounds(response: SwitchedRun, norms: Sequence[Norm]) -> Array:
    """Return the norm of each step over the first value; shape (N + 1,).

    Parameters
    ----------
    response : SwitchedRun
        A run that begins with a round.
    norms : sequence of callable
        One for each step of a round.
    """
    values = np.array([norms[t % len(norms)](x) for t, x in enumerate(response.state)])
    return np.asarray(values / values[0])
