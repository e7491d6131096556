"""Exact simulation of a switched linear system along a given signal."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.simulation.norms import Array, Norm
from nrs_design.simulation.rates import drift

# By which a state has grown enough to be seen.
_GROWTH = 100.0
# Growth per step below which a run of an unstable mode is shown as one on the stability limit.
_MARGINAL = 1e-5
_MARGINAL_STEPS = 628
_FEWEST, _MOST = 20, 4000
_DIRECTIONS = 500


@dataclass(frozen=True)
class SwitchedRun:
    """A sampled solution."""

    time: Array  # Shape (N + 1,). In s, or step numbers in discrete time.
    # Shape (N + 1, n). The state at these times, after the switch if there is one; where modes
    # differ in size, a smaller state is filled up with zeros.
    state: Array
    mode: NDArray[np.int64]  # Shape (N,). Index of the mode that was active in each interval.
    # Shape (N + 1,). Where modes take turns or miss deadlines, the state of that clock.
    turn: NDArray[np.int64] | None = None


def transition_matrices(system: SwitchedSystem, step: float) -> Array:
    """Return ``exp(A step)`` (or A, in discrete time) of every mode; shape (m, n, n)."""
    matrices = np.array([mode.A.floats() for mode in system.modes])
    if system.time is Time.DISCRETE:
        return matrices
    from scipy.linalg import expm

    return np.asarray(expm(matrices * step))


def simulate_switching(
    system: SwitchedSystem, signal: NDArray[np.int64], initial: Array, step: float
) -> SwitchedRun:
    """Simulate a switching signal that is constant over each step, exactly at the steps.

    The modes are of one size, without resets. The signal holds the index of the mode in each step
    of a time in s, one in discrete time.
    """
    transitions = transition_matrices(system, step)
    states = [initial]
    for mode in signal:
        states.append(transitions[mode] @ states[-1])
    return SwitchedRun(sampling_instants(step, len(signal)), np.array(states), signal)


def worst_direction(system: SwitchedSystem, Q: Array) -> Array:
    """Return the unit state (in the norm of Q) from which ``x' Q x`` decreases the slowest."""
    inverse = np.linalg.inv(np.linalg.cholesky(Q))
    worst = max((_slowest(inverse, form) for form in drift(system, Q)), key=lambda pair: pair[0])
    return inverse.T @ worst[1]


def sampled_direction(system: SwitchedSystem, norm: Norm, step: float) -> Array:
    """Return the state of norm one, among some, whose norm is largest after one step."""
    n = system.order
    rng = np.random.default_rng(0)
    directions = rng.standard_normal((_DIRECTIONS, n)) / norm(np.eye(n))
    directions /= norm(directions)[:, None]
    images = directions @ transition_matrices(system, step).transpose(0, 2, 1)
    return np.asarray(directions[norm(images).max(axis=0).argmax()])


def fine_step(system: SwitchedSystem) -> float:
    """Return a step that resolves the fastest eigenvalue, in s; one in discrete time."""
    if system.time is Time.DISCRETE:
        return 1.0
    fastest = max(float(np.abs(values).max()) for values in mode_eigenvalues(system))
    return 0.1 / fastest if fastest > 0 else 0.1


def mode_eigenvalues(system: SwitchedSystem) -> list[NDArray[np.complex128]]:
    """Return the eigenvalues of every mode, in 1/s in continuous time."""
    return [
        np.asarray(np.linalg.eigvals(np.array(mode.A.floats())), dtype=np.complex128)
        for mode in system.modes
    ]


def alone(system: SwitchedSystem, mode: int) -> SwitchedSystem:
    """Return the system that stays in one mode."""
    kept = system.modes[mode]
    return replace(system, modes=(kept,), states=system.states[: kept.A.shape[0]])


def unstable_run(system: SwitchedSystem, mode: int) -> SwitchedRun:
    """Stay in one mode, from the real part of the eigenvector that is worst for stability.

    The run ends when the eigenvalue has let the state grow a hundredfold; where it lies on the
    stability limit, after ten periods or time constants.
    """
    values, vectors = np.linalg.eig(np.array(system.modes[mode].A.floats()))
    continuous = system.time is Time.CONTINUOUS
    worst = int(np.argmax(values.real if continuous else np.abs(values)))
    initial = vectors[:, worst].real / np.linalg.norm(vectors[:, worst].real)
    step = fine_step(system)
    if continuous:
        exponent = float(values[worst].real) * step
    else:
        exponent = math.log(max(float(abs(values[worst])), 1.0))
    marginal = _MARGINAL_STEPS if continuous else _FEWEST
    steps = math.log(_GROWTH) / exponent if exponent > _MARGINAL else marginal
    signal = np.full(min(max(math.ceil(steps), _FEWEST), _MOST), mode, dtype=np.int64)
    return simulate_switching(system, signal, initial, step)


def sampling_instants(step: float, steps: int) -> Array:
    """Return sampling instants from zero; shape (steps + 1,)."""
    return np.asarray(step * np.arange(steps + 1), dtype=float)


def _slowest(inverse: Array, form: Array) -> tuple[float, Array]:
    values, vectors = np.linalg.eigh(inverse @ form @ inverse.T)
    return float(values[-1]), vectors[:, -1]
