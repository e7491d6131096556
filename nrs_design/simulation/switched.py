"""Exact simulation of a switched linear system, and of a switching that looks its worst."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nrs_design.switched.system import SwitchedSystem, Time

Array = NDArray[np.float64]

# Growth per step below which a run of an unstable mode is shown as one on the stability limit.
_MARGINAL = 1e-5
_MARGINAL_STEPS = 628
_FEWEST, _MOST = 20, 4000


@dataclass(frozen=True)
class TimeResponse:
    """A sampled solution.

    Parameters
    ----------
    time : ndarray, shape (N + 1,)
        In s, or step numbers in discrete time.
    state : ndarray, shape (N + 1, n)
        The state at these times.
    mode : ndarray of int, shape (N,)
        Index of the mode that was active in each interval.
    """

    time: Array
    state: Array
    mode: NDArray[np.int64]


def transition_matrices(system: SwitchedSystem, step: float) -> Array:
    """Return ``exp(A step)`` (or A, in discrete time) of every mode; shape (m, n, n)."""
    matrices = np.array([mode.A.floats() for mode in system.modes])
    if system.time is Time.DISCRETE:
        return matrices
    from scipy.linalg import expm

    return np.asarray(expm(matrices * step))


def simulate_switching(
    system: SwitchedSystem, signal: NDArray[np.int64], initial: Array, step: float
) -> TimeResponse:
    """Simulate a switching signal that is constant over each step, exactly at the steps.

    Parameters
    ----------
    system : SwitchedSystem
        Modes.
    signal : ndarray of int, shape (N,)
        Mode index in each step.
    initial : ndarray, shape (n,)
        State at time zero.
    step : float
        In s; one in discrete time.
    """
    transitions = transition_matrices(system, step)
    states = [initial]
    for mode in signal:
        states.append(transitions[mode] @ states[-1])
    return TimeResponse(_times(step, len(signal)), np.array(states), signal)


def worst_switching(
    system: SwitchedSystem, Q: Array, initial: Array, step: float, steps: int
) -> TimeResponse:
    """Simulate the greedy adversary: always the mode after which ``x' Q x`` is largest.

    It is a bad run, not the worst one: nothing is proved by it.

    Parameters
    ----------
    system : SwitchedSystem
        Modes.
    Q : ndarray, shape (n, n)
        Matrix of the function to make large.
    initial : ndarray, shape (n,)
        State at time zero.
    step : float
        Time between decisions, in s.
    steps : int
        Number of decisions N.
    """
    transitions = transition_matrices(system, step)
    states, chosen = [initial], []
    for _ in range(steps):
        candidates = transitions @ states[-1]
        values = ((candidates @ Q) * candidates).sum(axis=1)
        chosen.append(int(values.argmax()))
        states.append(candidates[chosen[-1]])
    return TimeResponse(_times(step, steps), np.array(states), np.array(chosen))


def worst_direction(system: SwitchedSystem, Q: Array) -> Array:
    """Return the unit state (in the norm of Q) from which ``x' Q x`` decreases the slowest."""
    inverse = np.linalg.inv(np.linalg.cholesky(Q))
    worst = max((_slowest(inverse, drift) for drift in _drift(system, Q)), key=lambda pair: pair[0])
    return inverse.T @ worst[1]


def mode_rates(system: SwitchedSystem, Q: Array) -> Array:
    """Return how fast ``sqrt(x' Q x)`` decays at least in every mode by itself.

    Parameters
    ----------
    system : SwitchedSystem
        Modes.
    Q : ndarray, shape (n, n)
        Symmetric and positive definite.

    Returns
    -------
    ndarray, shape (m,)
        Continuous time: the largest alpha with ``A'Q + QA + 2 alpha Q <= 0``, in 1/s; negative
        where the norm can grow. Discrete time: the smallest rho with ``A'QA <= rho^2 Q``.
    """
    inverse = np.linalg.inv(np.linalg.cholesky(Q))
    largest = np.linalg.eigvalsh(inverse @ np.array(_drift(system, Q)) @ inverse.T)[:, -1]
    if system.time is Time.DISCRETE:
        return np.asarray(np.sqrt(np.maximum(largest, 0.0)))
    return np.asarray(-largest / 2)


def norms(response: TimeResponse, Q: Array) -> Array:
    """Return ``sqrt(x' Q x)`` over its first value; shape (N + 1,)."""
    squares = np.einsum("ti,ij,tj->t", response.state, Q, response.state)
    return np.asarray(np.sqrt(np.maximum(squares, 0.0) / squares[0]))


def fine_step(system: SwitchedSystem) -> float:
    """Return a step that resolves the fastest eigenvalue, in s; one in discrete time."""
    if system.time is Time.DISCRETE:
        return 1.0
    fastest = float(np.abs(eigenvalues(system)).max())
    return 0.1 / fastest if fastest > 0 else 0.1


def eigenvalues(system: SwitchedSystem) -> NDArray[np.complex128]:
    """Return the eigenvalues of every mode, in 1/s in continuous time; shape (m, n)."""
    matrices = np.array([mode.A.floats() for mode in system.modes])
    return np.asarray(np.linalg.eigvals(matrices), dtype=np.complex128)


def unstable_run(system: SwitchedSystem, mode: int, growth: float = 100.0) -> TimeResponse:
    """Stay in one mode, from the real part of the eigenvector that is worst for stability.

    Parameters
    ----------
    system : SwitchedSystem
        Modes.
    mode : int
        Index of the mode to stay in.
    growth : float
        The run ends when the eigenvalue has let the state grow by this factor; where it lies on
        the stability limit, after ten periods or time constants.
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
    steps = math.log(growth) / exponent if exponent > _MARGINAL else marginal
    signal = np.full(min(max(math.ceil(steps), _FEWEST), _MOST), mode, dtype=np.int64)
    return simulate_switching(system, signal, initial, step)


def _drift(system: SwitchedSystem, Q: Array) -> list[Array]:
    matrices = [np.array(mode.A.floats()) for mode in system.modes]
    if system.time is Time.DISCRETE:
        return [A.T @ Q @ A for A in matrices]
    return [A.T @ Q + Q @ A for A in matrices]


def _slowest(inverse: Array, drift: Array) -> tuple[float, Array]:
    values, vectors = np.linalg.eigh(inverse @ drift @ inverse.T)
    return float(values[-1]), vectors[:, -1]


def _times(step: float, steps: int) -> Array:
    return np.asarray(step * np.arange(steps + 1), dtype=float)
