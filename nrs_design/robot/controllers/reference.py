"""Where the joints should be."""

from __future__ import annotations

from dataclasses import dataclass

from nrs_design.robot.models.vectors import Array


@dataclass(frozen=True, slots=True)
class JointReference:
    """Wanted motion of the joints, at one tick or at many."""

    # position, velocity, acceleration: of theta1, theta2, theta3 (not of the encoders), shape (...,
    # 3), in rad and s.
    position: Array
    velocity: Array
    acceleration: Array

    def at(self, tick: int) -> JointReference:
        """Return the reference of one tick of the first axis."""
        return JointReference(self.position[tick], self.velocity[tick], self.acceleration[tick])

    def of(self, rows: list[int]) -> JointReference:
        """Return the reference of some robots of a batch, at one tick."""
        return JointReference(self.position[rows], self.velocity[rows], self.acceleration[rows])
