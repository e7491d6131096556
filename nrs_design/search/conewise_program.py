"""The program of a quadratic function for contact and free motion (untrusted).

Margin form, as for a common quadratic function: maximize t subject to ``0 <= Q <= I`` and every
condition of `nrs_design.proof.evidence.conewise_quadratic` with at least t to spare. Conditions on
the block of y are filled up to the order of the others.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.contact import Contact
from nrs_design.proof.mode import Time
from nrs_design.search.balance import mean_norm_coordinates
from nrs_design.search.family import Family, to_floats
from nrs_design.search.interior_point import Cones, maximize_last, step_cost
from nrs_design.search.lmi import time_unit
from nrs_design.search.sdp import pack, symmetric_basis
from nrs_design.work import Allowance, Cost

Array = NDArray[np.float64]

# A multiplier lies between 0 and this, in coordinates where all numbers are of like size.
LARGEST_MULTIPLIER = 64.0
# The start lies below the margin of its Q by at least this.
START_FLOOR = 1e-3
FEWEST_STEPS = 4
# Rounding takes about as much as a smaller margin gives.
SMALLEST_MARGIN = 1e-10


@dataclass(frozen=True)
class Motions:
    """The maps in contact and free, in floating point."""

    time: Time  # Continuous or discrete
    contact: Array  # Shape (m, n, n). Modes in contact.
    free: Array  # Shape (f, n, n). Free modes.
    pulls: Array  # Shape (p, n). Forces of environments that could pull.

    @classmethod
    def of(cls, family: Family) -> Motions:
        """Convert the motions of a system to the coordinates of a family."""
        contact, d = family.system.contact or Contact(()), family.exponents
        free = to_floats([mode.A for mode in contact.free]).reshape(-1, len(d), len(d))
        rows = [to_floats([q])[0, 0] for q in contact.pulls]
        pulls = np.ldexp(np.array(rows).reshape(-1, len(d)), d[None, :])
        scaled = np.ldexp(free, d[None, :] - d[:, None])
        return cls(family.system.time, family.matrices, scaled, pulls)

    def transformed(self, T: Array) -> Motions:
        """Return the same in coordinates ``x = T z``."""
        inverse = np.linalg.inv(T)
        return Motions(
            self.time, inverse @ self.contact @ T, inverse @ self.free @ T, self.pulls @ T
        )


@dataclass(frozen=True)
class ConewiseSolution:
    """A quadratic function and its multipliers, in floating point."""

    Q: Array
    multipliers: Array


def separating_coordinates(motions: Motions) -> Array:
    """Return T that makes the mean of the modes' norms round, but leaves the deflection alone."""
    n = motions.contact.shape[-1]
    whole = mean_norm_coordinates(motions.contact, motions.time)
    Q = np.linalg.inv(whole @ whole.T)
    T = np.zeros((n, n))
    T[:-1, :-1] = np.linalg.inv(np.linalg.cholesky(Q[:-1, :-1])).T
    T[-1, -1] = 1 / np.sqrt(Q[-1, -1])
    return T


def find_conewise_quadratic(
    motions: Motions, rate: float, allowance: Allowance | None = None
) -> ConewiseSolution | None:
    """Look for a function that decreases at a rate in contact and free.

    Parameters
    ----------
    motions : Motions
        Balanced, or better: with modes of like norms.
    rate : float
        Decay rate in 1/s, or contraction per step.
    allowance : Allowance, optional
        Work and memory; unlimited by default.

    Returns
    -------
    ConewiseSolution or None
        With positive margins in floating point.

    Raises
    ------
    NotAffordableError
        If work or memory do not suffice.
    """
    allowance = allowance or Allowance()
    unit = time_unit(motions.contact, motions.time)
    if unit:
        contact, free = np.ldexp(motions.contact, unit), np.ldexp(motions.free, unit)
        motions = Motions(motions.time, contact, free, motions.pulls)
        rate = float(np.ldexp(rate, unit))
    n = motions.contact.shape[-1]
    basis, separations = symmetric_basis(n), _separations(motions)
    on_Q = _decreases(motions, basis, rate)
    counted = on_Q.shape[1]
    images = np.zeros((len(basis) + len(separations) + 1, counted + 2 + len(separations), n, n))
    constant = np.zeros(images.shape[1:])
    constant[:counted] = _filling(motions)
    constant[counted + 1] = np.eye(n)
    images[: len(basis), :counted] = on_Q
    images[: len(basis), counted], images[: len(basis), counted + 1] = basis, -basis
    for k, (where, form) in enumerate(separations):
        variable, cone = len(basis) + k, counted + 2 + k
        images[variable, where] = form
        constant[cone] = np.eye(n)
        constant[cone, 0, 0], constant[cone, 1, 1] = 0.0, LARGEST_MULTIPLIER
        images[variable, cone, 0, 0], images[variable, cone, 1, 1] = 1.0, -1.0
    images[-1, :counted] = constant[:counted] - np.eye(n)
    step = step_cost(len(images), len(constant), n)
    described = f"a program of {len(images)} unknowns and {len(constant)} blocks"
    allowance.require(Cost(FEWEST_STEPS * step.work, step.memory), described)
    cones = Cones(constant, images)
    start = np.concatenate([pack(np.eye(n) / 2), np.ones(len(separations)), [0.0]])
    here = cones.at(start)[:counted]
    start[-1] = np.linalg.eigvalsh(here).min() - max(0.1 * np.abs(here).max(), START_FLOOR)
    y = maximize_last(cones, start, lambda: allowance.goes_on(step.work), SMALLEST_MARGIN)
    if not y[-1] > 0:
        return None
    Q = np.asarray(np.tensordot(y[: len(basis)], basis, axes=1))
    return ConewiseSolution(Q, np.ldexp(y[len(basis) : -1], -unit))


def best_rate(motions: Motions, solution: ConewiseSolution) -> float:
    """Return the rate that a solution shows: alpha in 1/s, or rho per step.

    Parameters
    ----------
    motions : Motions
        For which it was found.
    solution : ConewiseSolution
        With a positive definite Q.
    """
    continuous, Q = motions.time is Time.CONTINUOUS, solution.Q
    forms = _decreases(motions, Q[None], 0.0)[0]
    for (where, form), multiplier in zip(_separations(motions), solution.multipliers, strict=True):
        forms[where] += multiplier * form
    full, inner = (
        np.linalg.inv(np.linalg.cholesky(Q)),
        np.linalg.inv(np.linalg.cholesky(Q[:-1, :-1])),
    )
    lowest = []
    for form, filled in zip(forms, _filling(motions)[:, -1, -1], strict=True):
        L, M = (inner, form[:-1, :-1]) if filled else (full, form)
        lowest.append(np.linalg.eigvalsh(L @ M @ L.T)[0])
    least = float(min(lowest))
    return least / 2 if continuous else float(np.sqrt(max(-least, 0.0)))


def _decreases(motions: Motions, Q: Array, rate: float) -> Array:
    """Return all conditions for a stack of Q, without multipliers; shape (k, conditions, n, n)."""
    Q, A, F = Q[:, None], motions.contact, motions.free
    inner = _inner(Q)
    if motions.time is Time.CONTINUOUS:
        lagging = np.repeat(_lyapunov(Q, F, rate), len(motions.pulls), axis=1)
        moves = [_lyapunov(Q, A, rate), _inner(_lyapunov(inner, _inner(F), rate)), lagging]
        return np.concatenate(moves, axis=1)
    if not len(F):
        return _stein(Q, A, Q, rate)
    others, moved = A.copy(), F.copy()
    others[:, -1] = 0.0
    moved[..., -1] = 0.0
    moves = [_stein(Q, A, Q, rate), _stein(Q, others, inner, rate)]
    moves += [_stein(inner, _inner(F), inner, rate), _stein(inner, moved, Q, rate)]
    landing = F.copy()
    landing[:, -1] = 0.0
    stays, leaves = _stein(Q, F, Q, rate), _stein(Q, landing, inner, rate)
    moves += [np.tile(part, (1, len(motions.pulls), 1, 1)) for part in (stays, leaves)]
    return np.concatenate(moves, axis=1)


def _lyapunov(Q: Array, A: Array, rate: float) -> Array:
    half = Q @ A
    return -(half + np.swapaxes(half, -1, -2)) - 2 * rate * Q


def _stein(before: Array, A: Array, after: Array, rate: float) -> Array:
    return rate**2 * before - np.swapaxes(A, -1, -2) @ after @ A


def _inner(M: Array) -> Array:
    """Set to zero what belongs to the deflection."""
    inner = M.copy()
    inner[..., -1, :] = 0.0
    inner[..., -1] = 0.0
    return inner


def _filling(motions: Motions) -> Array:
    """Return a one on the diagonal of each condition where there is no deflection."""
    contact, free, pulls, n = (
        *map(len, (motions.contact, motions.free, motions.pulls)),
        len(motions.contact[0]),
    )
    counts = (
        (contact, free, free * pulls)
        if motions.time is Time.CONTINUOUS
        else (2 * contact if free else contact, 2 * free, 2 * free * pulls)
    )
    filling = np.zeros((sum(counts), n, n))
    filling[counts[0] : counts[0] + counts[1], -1, -1] = 1.0
    return filling


def _separations(motions: Motions) -> list[tuple[NDArray[np.int64], Array]]:
    """Return, for each multiplier, which conditions it enters, and the forms that it multiplies."""
    m, f, p = map(len, (motions.contact, motions.free, motions.pulls))
    if motions.time is Time.CONTINUOUS:
        forms = _with_last(np.tile(motions.pulls, (f, 1)))
        return [(np.array([m + f + k]), form[None]) for k, form in enumerate(forms)] if p else []
    if not f:
        return []
    found = [(np.arange(m, 2 * m), _with_last(motions.contact[:, -1]))]
    for k, q in enumerate(motions.pulls):
        stays = 2 * m + 2 * f + k * f + np.arange(f)
        leaves, pulled = stays + f * p, _with_last(np.tile(q, (f, 1)))
        found += [(stays, pulled), (leaves, pulled), (leaves, _with_last(motions.free[:, -1]))]
    return found


def _with_last(rows: Array) -> Array:
    """Return ``e q + q' e'`` for rows q and the last unit vector e; shape (k, n, n)."""
    n = rows.shape[-1]
    forms = np.zeros((len(rows), n, n))
    forms[:, -1, :] += rows
    forms[:, :, -1] += rows
    return forms
