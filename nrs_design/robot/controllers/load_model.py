"""What a controller knows of the robot that it moves: inertia and weight at the measured pose."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from nrs_design.robot.models import (
    Robot,
    direct_kinematics,
    mass_and_bias,
    simplified_dynamics,
)
from nrs_design.robot.models.vectors import Array


@dataclass(frozen=True, slots=True)
class LoadTerms:
    """Terms that hold where the encoders stand."""

    angle: Array  # The encoders, shape (n, 3), in rad
    inertia: Array  # Shape (n, 3, 3), in kg m^2
    gravity: Array  # Shape (n, 3), in N m


@dataclass(frozen=True, slots=True)
class LoadModel:
    """Simplified dynamics with correction coefficients, ``K Ms`` and ``K Gs`` (thesis 4.17)."""

    robot: Robot  # On its base
    encoder_ratio: float  # Turns of the encoder per turn of the joint
    # K of the three joints (thesis 3.38). None takes the full dynamics M and G instead, which are
    # too much for the robot's processor: to see what the simplification costs.
    correction: tuple[float, float, float] | None

    def terms(self, angle: Array) -> LoadTerms:
        """Compute inertia and weight at encoder angles of shape (n, 3), in rad.

        Raises
        ------
        PoseError
            If no pose has these joint angles.
        """
        pose = direct_kinematics(self.robot, angle / self.encoder_ratio)
        if self.correction is None:
            return LoadTerms(angle, *mass_and_bias(self.robot, pose, np.zeros_like(pose)))
        K = np.array(self.correction)
        simplified = simplified_dynamics(self.robot, pose)
        return LoadTerms(angle, K[:, None] * simplified.Ms, K * simplified.Gs)

    def follow(self, angle: Array, known: LoadTerms | None) -> LoadTerms:
        """Return the terms at encoder angles, computing them only where an encoder has moved."""
        if known is None:
            return self.terms(angle)
        moved = np.any(angle != known.angle, axis=-1)
        if not moved.any():
            return known
        fresh = self.terms(angle[moved])
        inertia, gravity = known.inertia.copy(), known.gravity.copy()
        inertia[moved], gravity[moved] = fresh.inertia, fresh.gravity
        return LoadTerms(angle, inertia, gravity)
