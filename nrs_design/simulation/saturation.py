"""Runs in which signals saturate, with an adversary who chooses the modes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from nrs_design.proof.system import SwitchedSystem
from nrs_design.simulation.norms import Array, Norm
from nrs_design.simulation.switched import SwitchedRun, sampling_instants


def saturated_rates(system: SwitchedSystem) -> Callable[[Array], Array]:
    """Return the function from states, one for each mode and free mode, to their rates.

    Parameters
    ----------
    system : SwitchedSystem
        In continuous time, with what saturates.
    """
    saturation = system.saturation
    assert saturation is not None  # who asks has looked
    free = () if system.contact is None else system.contact.free
    A = np.array([mode.A.floats() for mode in (*system.modes, *free)])
    n, signals = system.order, saturation.signals
    columns = [np.array([c.floats() for c in s.columns])[:, :, 0] for s in signals]
    rows = [np.array([q.floats() for q in s.rows])[:, 0] for s in signals]

    def rates(states: Array) -> Array:
        moved = np.einsum("kij,kj->ki", A, states)
        cut, whole = list[Array](), list[Array]()
        for signal, column, row in zip(signals, columns, rows, strict=True):
            own = np.einsum("kj,kj->k", row[:, :n], states)
            argument, linear = own.copy(), own.copy()
            for i in range(len(cut)):
                argument += row[:, n + i] * cut[i]
                linear += row[:, n + i] * whole[i]
            limit = float(signal.limit)
            cut.append(np.clip(argument, -limit, limit))
            whole.append(linear)
            moved = moved + column * (cut[-1] - linear)[:, None]
        return np.asarray(moved)

    return rates


def worst_saturated(
    system: SwitchedSystem, norm: Norm, initial: Array, step: float, steps: int
) -> SwitchedRun:
    """Simulate the greedy adversary: always the possible mode after which the norm is largest.

    By the classical Runge-Kutta method; where contact can be lost, it changes at the end of a step
    only, so steps must be short. Nothing is proved by it.

    Parameters
    ----------
    system : SwitchedSystem
        In continuous time, with what saturates.
    norm : callable
        What to make large.
    initial : ndarray, shape (n,)
        State at time zero.
    step : float
        Time between decisions, in s.
    steps : int
        Number of decisions N.

    Returns
    -------
    SwitchedRun
        Its modes are those in contact, and after them those of free motion.
    """
    rates, count = saturated_rates(system), len(system.modes)
    total = count + (0 if system.contact is None else len(system.contact.free))
    states, chosen = [initial], []
    for _ in range(steps):
        x = np.tile(states[-1], (total, 1))
        k1 = rates(x)
        k2 = rates(x + step / 2 * k1)
        k3 = rates(x + step / 2 * k2)
        k4 = rates(x + step * k3)
        candidates = x + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        touching = total == count or states[-1][-1] > 0
        first, last = (0, count) if touching else (count, total)
        best = first + int(norm(candidates[first:last]).argmax())
        chosen.append(best)
        states.append(candidates[best])
    return SwitchedRun(sampling_instants(step, steps), np.array(states), np.array(chosen))
