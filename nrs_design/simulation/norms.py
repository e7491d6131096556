"""Lyapunov functions in floating point, as norms of states."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.exact import IntegerMatrix
from nrs_design.proof.lift import monomials
from nrs_design.proof.switching import Switching
from nrs_design.proof.system import SwitchedSystem

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

# From states, shape (..., n), to their norms, shape (...); twice the state has twice the norm.
Norm = Callable[[Array], Array]


def quadratic_norm(Q: Array) -> Norm:
    """Return ``sqrt(x' Q x)``; Q is symmetric and positive definite."""
    root = np.linalg.cholesky(Q)

    def norm(states: Array) -> Array:
        return np.asarray(np.linalg.norm(states @ root, axis=-1))

    return norm


def clipped(norm: Norm) -> Norm:
    """Return the norm of ``w = (y, max(delta, 0))``; the deflection is the last state."""
    return lambda states: norm(deflected(states))


def deflected(states: Array) -> Array:
    """Return ``w = (y, max(delta, 0))`` of states, of which the deflection is the last entry."""
    w = states.copy()
    w[..., -1] = np.maximum(w[..., -1], 0.0)
    return w


def polynomial_norm(Q: IntegerMatrix, degree: int, order: int) -> Norm:
    """Return ``V(x)^(1/2d)`` times a constant, for a form V of degree 2d in n states.

    Q is the Gram matrix of V, in the monomials as `lift.monomials` orders them.
    """
    basis, (gram,) = np.array(monomials(order, degree)), scaled_matrices(Q)

    def norm(states: Array) -> Array:
        z = np.prod(states[..., None, :] ** basis, axis=-1)
        return np.asarray(np.maximum((z @ gram * z).sum(axis=-1), 0.0) ** (1 / (2 * degree)))

    return norm


def scaled_matrices(*matrices: IntegerMatrix) -> list[Array]:
    """Return symmetric matrices in floating point, all divided by their largest entry."""
    largest = max(abs(entry) for M in matrices for row in M for entry in row)
    return [np.array([[entry / largest for entry in row] for row in M]) for M in matrices]


def modes_at_corner(system: SwitchedSystem, corner: int) -> SwitchedSystem:
    """Return the modes at one corner of the constant parameters, switched arbitrarily."""
    names = {corners[corner] for corners in system.switching.fixed_ends}
    modes = tuple(mode for mode in system.modes if mode.name in names)
    return system.with_modes(modes, system.states, Switching())
