"""Runs in which contact is lost and made again, with an adversary who chooses the modes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.simulation.norms import Array, Norm
from nrs_design.simulation.switched import SwitchedRun, sampling_instants, transition_matrices


def with_free_modes(system: SwitchedSystem) -> SwitchedSystem:
    """Return the modes in contact and those of free motion as one family, in this order."""
    assert system.contact is not None
    return replace(system, modes=(*system.modes, *system.contact.free), contact=None)


def clipped(norm: Norm) -> Norm:
    """Return the norm of ``w = (y, max(delta, 0))``.

    Parameters
    ----------
    norm : callable
        Of states, of which the deflection is the last entry.
    """
    return lambda states: norm(deflected(states))


def deflected(states: Array) -> Array:
    """Return ``w = (y, max(delta, 0))`` of states, of which the deflection is the last entry."""
    w = states.copy()
    w[..., -1] = np.maximum(w[..., -1], 0.0)
    return w


def worst_contact(
    system: SwitchedSystem, norm: Norm, initial: Array, step: float, steps: int
) -> SwitchedRun:
    """Simulate the greedy adversary: always the possible mode after which the norm is largest.

    Modes in contact are possible while the deflection is positive, and free ones while it is not.
    In continuous time, contact changes at the end of a step only, so steps must be short. Nothing
    is proved by it.

    Parameters
    ----------
    system : SwitchedSystem
        With its contact.
    norm : callable
        What to make large, as `clipped` gives it.
    initial : ndarray, shape (n,)
        State at time zero.
    step : float
        Time between decisions, in s; one in discrete time.
    steps : int
        Number of decisions N.

    Returns
    -------
    SwitchedRun
        Its modes are those of `with_free_modes`.
    """
    transitions = transition_matrices(with_free_modes(system), step)
    count = len(system.modes)
    states, chosen = [initial], []
    for _ in range(steps):
        touching = bool(states[-1][-1] > 0)
        first = 0 if touching else count
        candidates = (transitions[:count] if touching else transitions[count:]) @ states[-1]
        best = int(norm(candidates).argmax())
        chosen.append(first + best)
        states.append(candidates[best])
    unit = 1.0 if system.time is Time.DISCRETE else step
    return SwitchedRun(sampling_instants(unit, steps), np.array(states), np.array(chosen))
