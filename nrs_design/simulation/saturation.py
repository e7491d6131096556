"""Motion with signals that saturate."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.simulation.norms import Array, Indices
from nrs_design.simulation.switched import all_modes, mode_matrices


def saturated_rates(system: SwitchedSystem) -> Callable[[Array], Array]:
    """Return the function from states, one for each mode and free mode, to their rates.

    In discrete time it leads to the next states.
    """
    saturation = system.saturation
    assert saturation is not None
    A = np.array(mode_matrices(all_modes(system)))
    columns = [np.array([c.floats() for c in s.columns])[:, :, 0] for s in saturation.signals]
    rows = [np.array([q.floats() for q in s.rows])[:, 0] for s in saturation.signals]

    def rates(states: Array) -> Array:
        derivatives = np.einsum("kij,kj->ki", A, states)
        # A signal depends on the states and on the signals before it, saturated or linear.
        saturated = linear = states
        for signal, row, column in zip(saturation.signals, rows, columns, strict=True):
            argument, linear_value = (
                (row[:, : x.shape[1]] * x).sum(axis=1) for x in (saturated, linear)
            )
            limit = float(signal.limit)
            clipped = np.clip(argument, -limit, limit)
            derivatives += column * (clipped - linear_value)[:, None]
            saturated = np.column_stack([saturated, clipped])
            linear = np.column_stack([linear, linear_value])
        return np.asarray(derivatives)

    return rates


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
