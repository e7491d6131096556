"""Exact simulation of a switched linear system along a given signal."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from nrs_design.late import late_function
from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.simulation.norms import Array, Indices, Norm

# SciPy takes longer to load than most runs take.
expm = late_function("scipy.linalg", "expm")

_DIRECTIONS = 500


@dataclass(frozen=True)
class SwitchedRun:
    """A sampled solution."""

    time: Array  # Shape (N + 1,). In s, or step numbers in discrete time.
    # Shape (N + 1, n). States after switches; zeros fill up smaller states.
    state: Array
    mode: Indices  # Shape (N,). Index of the mode that was active in each interval.
    # Shape (N + 1,). State of the clock, where the system has one.
    turn: Indices | None = None


def mode_matrices(system: SwitchedSystem) -> list[Array]:
    """Return A of every mode in floating point."""
    return [np.array(mode.A.floats()) for mode in system.modes]


def transition_matrices(system: SwitchedSystem, step: float) -> Array:
    """Return ``exp(A step)`` (or A, in discrete time) of every mode; shape (m, n, n)."""
    matrices = np.array(mode_matrices(system))
    return matrices if system.time is Time.DISCRETE else np.asarray(expm(matrices * step))


def mode_rates(system: SwitchedSystem, Q: Array) -> Array:
    """Return the least decay of ``sqrt(x' Q x)`` in every mode alone, shape (m,).

    Continuous time: the largest alpha with ``A'Q + QA + 2 alpha Q <= 0``, in 1/s; negative where
    the norm can grow. Discrete time: the smallest rho with ``A'QA <= rho^2 Q``. For figures only.
    """
    largest = np.linalg.eigvalsh(np.array(_relative_forms(system, Q)))[:, -1]
    if system.time is Time.DISCRETE:
        return np.asarray(np.sqrt(np.maximum(largest, 0.0)))
    return np.asarray(-largest / 2)


def worst_direction(system: SwitchedSystem, Q: Array) -> Array:
    """Return the unit state (in the norm of Q) from which ``x' Q x`` decreases the slowest."""
    spectra = map(np.linalg.eigh, _relative_forms(system, Q))
    _, vectors = max(spectra, key=lambda spectrum: float(spectrum[0][-1]))
    return np.asarray(np.linalg.inv(np.linalg.cholesky(Q)).T @ vectors[:, -1])


def _relative_forms(system: SwitchedSystem, Q: Array) -> list[Array]:
    """Return ``A'Q + QA`` (discrete time: ``A'QA``) of every mode, relative to Q."""
    inverse, discrete = np.linalg.inv(np.linalg.cholesky(Q)), system.time is Time.DISCRETE
    forms = (A.T @ Q @ A if discrete else A.T @ Q + Q @ A for A in mode_matrices(system))
    return [inverse @ form @ inverse.T for form in forms]


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
    return [np.asarray(np.linalg.eigvals(A), np.complex128) for A in mode_matrices(system)]


def all_modes(system: SwitchedSystem) -> SwitchedSystem:
    """Return a system of all modes, in contact and in free motion."""
    if system.contact is None:
        return system
    return replace(system, modes=(*system.modes, *system.contact.free), contact=None)


def single_mode_system(system: SwitchedSystem, mode: int) -> SwitchedSystem:
    """Return the system that stays in one mode."""
    single = system.modes[mode]
    return replace(system, modes=(single,), states=system.states[: single.A.shape[0]])
