"""Motion with signals that saturate."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from nrs_design.proof.mode import Time
from nrs_design.proof.saturation import Saturation
from nrs_design.proof.system import SwitchedSystem
from nrs_design.simulation.norms import Array, Indices
from nrs_design.simulation.switched import all_modes


def saturated_rates(system: SwitchedSystem) -> Callable[[Array], Array]:
    """Return the function from states, one for each mode and free mode, to their rates.

    In discrete time it leads to the next states.
    """
    saturation = system.saturation
    assert saturation is not None  # who asks has looked
    A = np.array([mode.A.floats() for mode in all_modes(system).modes])
    columns = [np.array([c.floats() for c in s.columns])[:, :, 0] for s in saturation.signals]
    rows = _rows(saturation)

    def rates(states: Array) -> Array:
        moved = np.einsum("kij,kj->ki", A, states)
        signals = _signals(saturation, rows, states)
        for column, (_, cut, linear) in zip(columns, signals, strict=True):
            moved += column * (cut - linear)[:, None]
        return np.asarray(moved)

    return rates


def _rows(saturation: Saturation) -> list[Array]:
    """Return the q of every signal, one below the other for all modes."""
    return [np.array([q.floats() for q in s.rows])[:, 0] for s in saturation.signals]


def _signals(
    saturation: Saturation, rows: Sequence[Array], states: Array
) -> list[tuple[Array, Array, Array]]:
    """Return argument, saturated value and linear value of each signal at some states."""
    found: list[tuple[Array, Array, Array]] = []
    # What a signal depends on: the states, and the signals before it, cut off and not.
    cut = linear = states
    for signal, row in zip(saturation.signals, rows, strict=True):
        argument, whole = ((row[:, : x.shape[1]] * x).sum(axis=1) for x in (cut, linear))
        limit = float(signal.limit)
        found.append((argument, np.clip(argument, -limit, limit), whole))
        cut, linear = (np.column_stack([x, y]) for x, y in ((cut, found[-1][1]), (linear, whole)))
    return found


def saturated_step(system: SwitchedSystem, step: float) -> Callable[[Array, Indices], Array]:
    """Return the function from a state and modes to the states after a step in each of them.

    By the classical Runge-Kutta method in continuous time; in discrete time the step is that of the
    system.
    """
    rates, total = saturated_rates(system), len(all_modes(system).modes)

    def advance(x: Array, modes: Indices) -> Array:
        x = np.tile(x, (total, 1))
        if system.time is Time.DISCRETE:
            return rates(x)[modes]
        k1 = rates(x)
        k2 = rates(x + step / 2 * k1)
        k3 = rates(x + step / 2 * k2)
        k4 = rates(x + step * k3)
        return np.asarray((x + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4))[modes])

    return advance
