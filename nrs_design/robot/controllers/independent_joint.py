"""Independent joints: a PD on each, with the weight fed forward or balanced by springs."""

from __future__ import annotations

from dataclasses import dataclass

from nrs_design.controllers.laws import ProportionalDerivative
from nrs_design.robot.controllers.load_model import LoadModel
from nrs_design.robot.controllers.reference import JointReference
from nrs_design.robot.controllers.state import LawState
from nrs_design.robot.models.vectors import Array


@dataclass(frozen=True, slots=True)
class IndependentJoint:
    """PD on each joint (thesis 4.3), with or without its weight fed forward.

    ``delta = Kp e + Kd e' + (gradient/N) K_corr Gs``, the error e in encoder coordinates. The
    thesis prints 4.32 and 4.36 with the speed-torque gradient before all three terms; the PD of
    4.30 is designed from encoder angle to command, so that it is in rpm already.
    """

    # Gains in rpm/rad and rpm s/rad, as on the robot in single precision.
    motion: ProportionalDerivative
    period: float  # Time between two ticks in s
    encoder_ratio: float  # Turns of the encoder per turn of the joint
    command_per_torque: float  # Command that holds a joint torque, ``gradient/N`` in rpm/(N m)
    # Where the weight comes from. None feeds nothing forward, for the balanced robot (4.36).
    load: LoadModel | None

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
        rate = state.error_rate(error, self.period)
        command = float(self.motion.Kp) * error + float(self.motion.Kd) * rate
        if self.load is None:
            return command, LawState(error)
        load = self.load.follow(angle, state.load)
        return command + self.command_per_torque * load.gravity, LawState(error, load)
