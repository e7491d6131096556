"""The simplified dynamics, and coefficients from its torque to the full one (thesis 3.3 to 3.5).

Nothing but the platform and the rotor of the middle leg counts. The platform's angular velocity is
``(theta_x', cos(theta_x) theta_y', sin(theta_x) theta_y')``; thesis 3.33 leaves the cosine and the
sine out. It is written here with the base axis of the middle leg, about which the platform turns by
theta_x, and its own y axis, so that it holds for every azimuth of that leg.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import ArrayLike

from nrs_design.robot.models.dynamics import gravity_torque
from nrs_design.robot.models.geometry import Posture, posture
from nrs_design.robot.models.motion import joint_driven
from nrs_design.robot.models.robot import Robot
from nrs_design.robot.models.vectors import Array, cross, root_mean_square, scale, stack


@dataclass(frozen=True, slots=True)
class SimplifiedDynamics:
    """Ms in kg m^2, shape (..., 3, 3), and Gs in N m, shape (..., 3)."""

    Ms: Array
    Gs: Array


def simplified_dynamics(
    robot: Robot, pose: ArrayLike, *, printed: bool = False
) -> SimplifiedDynamics:
    """Return Ms and Gs (thesis 3.35 and 3.37), which the robot can compute at every tick.

    Of the robot only platform and axis inertia of the middle leg count. `printed` takes the angular
    velocity as printed in 3.33, ``(theta_x', theta_y', 0)``, to reproduce the thesis.
    """
    closed = posture(robot, pose)
    frame, body = _platform_frame(closed), robot.platform
    rates = _rates(closed)
    about_x = np.broadcast_to(robot.legs[2].axis, frame.shape[:-1])
    about_y = frame[..., :, 1]
    arm = frame @ body.center_of_mass + np.asarray(closed.d)[..., None] * frame[..., :, 2]
    linear = np.stack([np.cross(about_x, arm), np.cross(about_y, arm), frame[..., 2]], -1) @ rates
    if printed:
        about_y = np.broadcast_to(np.cross((0.0, 0.0, 1.0), robot.legs[2].axis), about_y.shape)
    angular = np.stack([about_x, about_y, np.zeros_like(about_x)], -1) @ rates
    Ms = (
        body.mass * linear.mT @ linear
        + angular.mT @ frame @ body.inertia @ frame.mT @ angular
        + robot.legs[2].axis_inertia * rates[..., 0, :, None] * rates[..., 0, None, :]
    )
    Gs = -body.mass * linear.mT @ np.asarray(robot.gravity_vector)
    return SimplifiedDynamics(Ms, Gs)


def _rates(closed: Posture) -> Array:
    """Jacobian of (theta_x, theta_y, d) of the platform; shape (..., 3, 3)."""
    units = np.eye(3).reshape(3, *(1 for _ in np.shape(closed.d)), 3)
    motion = joint_driven(closed, units, np.zeros(3))
    middle = motion.legs[2]
    columns = stack((middle.alpha_1, -middle.gamma_1, motion.d_1))
    return np.asarray(np.moveaxis(columns, 0, -1), dtype=np.float64)


def _platform_frame(closed: Posture) -> Array:
    """Rotation from the platform's frame to the base frame; shape (..., 3, 3)."""
    middle = closed.legs[2]
    y = scale(-1.0, middle.normal)
    x = cross(y, closed.W)
    return np.stack([stack(x), stack(y), stack(closed.W)], axis=-1)


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
# Last row of the table: the full workspace.
WHOLE_WORKSPACE = Sine(0.2618, 0.3491, (0.150, 0.250))
# Motions for the comparison of tilts: the depth moves, the angles are zero.
DEPTH_SINES = tuple(Sine(0.0, 0.0, d) for d in DEPTHS)


@dataclass(frozen=True, slots=True)
class Correction:
    """Coefficients of the three joints, and what torque error they leave."""

    mean_ratio: Array  # ``mean(T*/T)`` (thesis 3.38), shape (3,)
    # ``sum(T* T)/sum(T^2)``, shape (3,), defined also where a simplified torque passes zero.
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
    """Return the coefficients over one trajectory, or their means over several."""
    trajectories = (sines,) if isinstance(sines, Sine) else sines
    return correct(*(_torques(robot, sine) for sine in trajectories))


@dataclass(frozen=True, slots=True)
class TiltTable:
    """Coefficients against the tilt of the base (thesis fig. 3.12)."""

    tilt: Array  # theta4 in rad, shape (n,)
    # mean_ratio, least_squares: shape (n, 3).
    mean_ratio: Array
    least_squares: Array


def tilt_table(robot: Robot, tilts: Array, sines: Sequence[Sine]) -> TiltTable:
    """Return the coefficients over some motions at tilts in rad, shape (n,)."""
    fits = [correction_coefficients(robot.tilted(float(tilt)), sines) for tilt in tilts]
    ratios, squares = zip(*((fit.mean_ratio, fit.least_squares) for fit in fits), strict=True)
    return TiltTable(tilts, np.array(ratios), np.array(squares))


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
