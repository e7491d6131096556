"""Correction coefficients: from the simplified to the full torque (thesis 3.4 and 3.5)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import pi

import numpy as np

from nrs_design.robot.models.dynamics import gravity_torque
from nrs_design.robot.models.robot import Robot
from nrs_design.robot.models.simplified import simplified_dynamics
from nrs_design.robot.models.vectors import Array, root_mean_square

SAMPLES = 720


@dataclass(frozen=True, slots=True)
class Sine:
    """Sines of phi, psi and d in phase, so slow that only gravity counts (thesis table 3.5)."""

    # phi, psi: amplitudes in rad.
    phi: float
    psi: float
    d: tuple[float, float]  # Smallest and largest depth in m


DEPTHS = ((0.150, 0.160), (0.195, 0.205), (0.240, 0.250))
# The twelve rows of thesis table 3.5 that are plain sines, in its order.
TABLE_3_5 = tuple(
    Sine(phi, psi, d) for d in DEPTHS for phi in (0.0, 0.1205) for psi in (0.0, 0.2043)
)
# Its last row: the whole workspace.
WHOLE_WORKSPACE = Sine(0.2618, 0.3491, (0.150, 0.250))
# What the tilts are compared on: the depth moves, the angles are zero.
DEPTH_SINES = tuple(Sine(0.0, 0.0, d) for d in DEPTHS)


@dataclass(frozen=True, slots=True)
class Correction:
    """Coefficients of the three joints, and what torque error they leave."""

    mean_ratio: Array  # ``mean(T*/T)`` (thesis 3.38), shape (3,)
    # ``sum(T* T)/sum(T^2)``, shape (3,): it stays defined where a simplified torque passes zero.
    least_squares: Array
    # Root mean square of ``T* - K T`` with either, in N m, shape (3,).
    mean_ratio_error: Array
    least_squares_error: Array


def correct(*torques: tuple[Array, Array]) -> Correction:
    """Return the coefficients that take simplified torques to full ones.

    Each pair has the full and the simplified torques of a motion, shapes (n, 3), in N m.
    Coefficients are means of those of each motion; errors are over all of them.
    """
    mean_ratio = np.mean([(T / t).mean(axis=0) for T, t in torques], axis=0)
    least_squares = np.mean([(T * t).sum(axis=0) / (t * t).sum(axis=0) for T, t in torques], axis=0)
    T, t = (np.concatenate(parts) for parts in zip(*torques, strict=True))
    errors = (root_mean_square(T - K * t) for K in (mean_ratio, least_squares))
    return Correction(mean_ratio, least_squares, *errors)


def correction_coefficients(robot: Robot, sines: Sine | Sequence[Sine]) -> Correction:
    """Return the coefficients over one or several trajectories; of several, their means."""
    chosen = (sines,) if isinstance(sines, Sine) else sines
    return correct(*(_torques(robot, sine) for sine in chosen))


@dataclass(frozen=True, slots=True)
class TiltTable:
    """Coefficients against the tilt of the base (thesis fig. 3.12)."""

    tilt: Array  # theta4 in rad, shape (n,)
    # mean_ratio, least_squares: shape (n, 3).
    mean_ratio: Array
    least_squares: Array


def tilt_tables(
    robot: Robot, tilts: Iterable[float], *groups: Sequence[Sine]
) -> tuple[TiltTable, ...]:
    """Return a table for each group of motions, tilts in rad; shared motions are computed once."""
    chosen = np.array(list(tilts), dtype=np.float64)
    tilted = [robot.tilted(float(tilt)) for tilt in chosen]
    fits = {
        sine: [correction_coefficients(each, sine) for each in tilted]
        for sine in dict.fromkeys(sine for group in groups for sine in group)
    }
    return tuple(
        TiltTable(
            chosen,
            np.mean([[fit.mean_ratio for fit in fits[sine]] for sine in group], axis=0),
            np.mean([[fit.least_squares for fit in fits[sine]] for sine in group], axis=0),
        )
        for group in groups
    )


def to_csv(table: TiltTable) -> str:
    """Write a table for the controller: one line for each tilt, coefficients by mean ratio."""
    lines = ["theta4_deg,K1,K2,K3,K1_least_squares,K2_least_squares,K3_least_squares"]
    for tilt, ratio, squares in zip(
        np.degrees(table.tilt), table.mean_ratio, table.least_squares, strict=True
    ):
        lines.append(",".join([f"{tilt:.6g}", *(f"{k:.6f}" for k in (*ratio, *squares))]))
    return "\n".join(lines) + "\n"


def thesis_tilts() -> Array:
    """Return the tilts of thesis 3.5, -75 to 0 deg by 1 deg, in rad."""
    return np.asarray(np.radians(np.arange(-75.0, 1.0)))


def _torques(robot: Robot, sine: Sine) -> tuple[Array, Array]:
    """Full and simplified torques along a trajectory; shapes (SAMPLES, 3)."""
    phase = 2 * pi * (np.arange(SAMPLES) + 0.5) / SAMPLES
    low, high = sine.d
    swing = np.array([sine.phi, sine.psi, (high - low) / 2])
    pose = np.array([0.0, 0.0, (high + low) / 2]) + np.sin(phase)[:, None] * swing
    return gravity_torque(robot, pose), simplified_dynamics(robot, pose).Gs
