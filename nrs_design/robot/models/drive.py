"""The drive of one joint, seen from the joint: motor, driver, gearhead and capstan (thesis 4.1)."""

from __future__ import annotations

from dataclasses import dataclass

from nrs_design.errors import DesignError
from nrs_design.robot.models.vectors import Scalar
from nrs_design.spec.robot import DriveSpec

# Tolerance for rounded digits of four dependent numbers. The numbers of the thesis agree within
# 0.01 %, and within 0.8 % with the printed gradient.
AGREEMENT = 0.05


@dataclass(frozen=True, slots=True)
class JointDrive:
    """A drive that turns the joint by ``inertia q'' + damping q' = torque_per_command delta - f``.

    The load acts on top: ``f`` is dry friction and what the robot asks for. All of it follows
    from the motor (thesis 4.2 to 4.10, with the signs and factors corrected)::

        I_r w' = (delta - w/K)/gradient - T,   w = N q',   T = torque at the joint/N,

    with the speed K of the motor per command, ``gain * gearhead_ratio``, and N the ratio of both
    gears. The friction of the motor that the gain K accounts for is part of the damping.
    """

    # Rotations of the encoder, at the gearhead's output, per rotation of the joint: 5 in the
    # thesis.
    encoder_ratio: Scalar
    inertia: Scalar  # Inertia of the rotor at the joint, ``N^2 I_r`` in kg m^2
    damping: Scalar  # ``N^2/(K gradient)`` in N m s/rad
    torque_per_command: Scalar  # ``N/gradient`` in N m/rpm
    friction: Scalar  # Largest dry friction at the joint in N m


def build_drive(spec: DriveSpec) -> JointDrive:
    """Convert a drive to the joint's side, in SI units, and rpm for commands.

    A time constant other than ``I_r K gradient`` contradicts the rest, and is a `DesignError`.
    """
    gearhead, capstan = float(spec.gearhead_ratio), float(spec.capstan_ratio)
    ratio, speed = gearhead * capstan, spec.gain.si * gearhead
    gradient, inertia = spec.speed_torque_gradient.si, spec.rotor_inertia.si
    expected = inertia * speed * gradient
    if abs(expected - spec.time_constant.si) > AGREEMENT * spec.time_constant.si:
        raise DesignError(
            f"the numbers of the drive contradict each other: rotor inertia, gain and gradient "
            f"give a time constant of {expected:.4g} s, the spec says {spec.time_constant.si:.4g} "
            "s",
            remedy="correct one of the four",
            at=("drive",),
        )
    return JointDrive(
        encoder_ratio=capstan,
        inertia=ratio**2 * inertia,
        damping=ratio**2 / (speed * gradient),
        torque_per_command=ratio / gradient,
        friction=ratio / gradient * spec.coulomb_friction.si,
    )
