"""Computed torque with simplified dynamics (thesis 4.2)."""

from __future__ import annotations

from dataclasses import dataclass

from nrs_design.robot.controllers.load_model import LoadModel
from nrs_design.robot.controllers.reference import JointReference
from nrs_design.robot.controllers.state import LawState
from nrs_design.robot.models.vectors import Array


@dataclass(frozen=True, slots=True)
class ComputedTorque:
    """Torque for a wanted acceleration, as a command (thesis 4.16 to 4.18, corrected).

    ``a = theta_des'' + Kd e' + Kp e`` and ``delta = gradient (K_corr Ms a/(N n) + K_corr Gs/N)``,
    with e and a in encoder coordinates, n turns of the encoder and N of the motor per turn of the
    joint. The acceleration in 4.16 is that of the reference.

    The law of the thesis knows the robot and not its motors. Their inertia and damping, as seen
    from the joints, can be added, to see what that costs; both are 0 in the thesis.
    """

    # Kp, Kd: in 1/s^2 and 1/s (thesis 4.15).
    Kp: float
    Kd: float
    period: float  # Time between two ticks in s
    encoder_ratio: float  # Turns n of the encoder per turn of the joint
    command_per_torque: float  # Command that holds a joint torque, ``gradient/N`` in rpm/(N m)
    load: LoadModel  # Inertia and weight
    rotor_inertia: float = 0.0  # Of a motor at its joint, in kg m^2
    motor_damping: float = 0.0  # Torque per speed of the reference, at the joint, in N m s/rad

    def step(
        self, state: LawState, reference: JointReference, angle: Array
    ) -> tuple[Array, LawState]:
        """Compute the commands of one tick, for a batch of robots.

        Parameters
        ----------
        state : LawState
            As the last tick returned it; `LawState()` at first.
        reference : JointReference
            Of this tick, shapes (n, 3).
        angle : ndarray
            Encoders, shape (n, 3), in rad.

        Returns
        -------
        tuple of ndarray and LawState
            Commands in rpm, shape (n, 3), and what the next tick needs.
        """
        error = self.encoder_ratio * reference.position - angle
        feedback = self.Kp * error + self.Kd * state.error_rate(error, self.period)
        wanted = reference.acceleration + feedback / self.encoder_ratio
        load = self.load.follow(angle, state.load)
        torque = (load.inertia @ wanted[..., None])[..., 0] + load.gravity
        torque = torque + self.rotor_inertia * wanted + self.motor_damping * reference.velocity
        return self.command_per_torque * torque, LawState(error, load)
