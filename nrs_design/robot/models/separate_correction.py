"""Correction of inertia and gravity apart, as chapter 8 of the thesis proposes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from nrs_design.robot.models.dynamics import gravity_torque, mass_matrix
from nrs_design.robot.models.robot import Robot
from nrs_design.robot.models.simplified import simplified_dynamics
from nrs_design.robot.models.vectors import Array


@dataclass(frozen=True, slots=True)
class SeparateCorrection:
    """Coefficients by least squares over poses, and the error that each leaves."""

    # ``G = K Gs``, shape (3,): what a single correction has for gravity and inertia alike.
    gravity: Array
    inertia_rows: Array  # ``M = K Ms`` with one number for each joint, shape (3,)
    inertia_entries: Array  # One number for each entry of Ms, shape (3, 3)
    gravity_error: float  # Root mean square of ``G - K Gs`` over that of G
    # single_error, rows_error, entries_error: the same for M, with the coefficients of gravity, by
    # rows and by entries.
    single_error: float
    rows_error: float
    entries_error: float


def correct_separately(robot: Robot, poses: ArrayLike) -> SeparateCorrection:
    """Fit the simplified mass matrix and the simplified weight to the full ones, each on its own.

    Parameters
    ----------
    robot : Robot
        The robot, on its base.
    poses : array_like
        phi, psi in rad and d in m, shape (..., 3).

    Returns
    -------
    SeparateCorrection
        Over all poses alike.
    """
    simplified = simplified_dynamics(robot, poses)
    M, Ms = (A.reshape(-1, 3, 3) for A in (mass_matrix(robot, poses), simplified.Ms))
    G, Gs = (v.reshape(-1, 3) for v in (gravity_torque(robot, poses), simplified.Gs))
    gravity = (G * Gs).sum(axis=0) / (Gs**2).sum(axis=0)
    rows = (M * Ms).sum(axis=(0, 2)) / (Ms**2).sum(axis=(0, 2))
    entries = (M * Ms).sum(axis=0) / (Ms**2).sum(axis=0)
    return SeparateCorrection(
        gravity,
        rows,
        entries,
        _error(G, gravity * Gs),
        _error(M, gravity[:, None] * Ms),
        _error(M, rows[:, None] * Ms),
        _error(M, entries * Ms),
    )


def _error(full: Array, corrected: Array) -> float:
    return float(np.linalg.norm(full - corrected) / np.linalg.norm(full))
