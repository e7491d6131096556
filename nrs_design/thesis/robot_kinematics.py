"""Chapter 3.1: kinematics, its misprints, and the joint speeds of 3.3."""

from __future__ import annotations

import numpy as np

from nrs_design.robot.models import (
    Robot,
    inverse_jacobian,
    inverse_kinematics,
    joint_peaks,
    orientation,
    orientation_jacobian,
    pose_grid,
    thesis_grid,
)
from nrs_design.robot.models.geometry import direction
from nrs_design.robot.models.neuroboscope import robot
from nrs_design.robot.models.vectors import Array
from nrs_design.thesis.comparison import (
    PrintVerdict,
    ReproducedValue,
    Tolerance,
    claim,
    fitted,
    misprint,
    near,
    reproduced,
)

POSE = (0.1, -0.2, 0.2)
_ROUNDING = 1e-12
# In 1/s: both accelerations of the task that 3.3 prints over their speeds.
ACCELERATION_PER_SPEED = 3.7


def rows() -> tuple[ReproducedValue, ...]:
    """Recompute the crank angle, the orientation and the joint speeds."""
    return (_crank_angle(robot()), _crank_range(robot()), *_orientation(), *_speeds(robot()))


def _crank_angle(ours: Robot) -> ReproducedValue:
    return misprint(
        "theta3 at phi 0.1, psi -0.2 rad, d 200 mm",
        "3.10",
        "atan2(Lambda, chi) - acos(Upsilon/U)",
        float(inverse_kinematics(ours, POSE)[2]),
        "rad",
        Tolerance(absolute=1e-6),
        right="0.804771",
        note="The arguments are exchanged: atan2(chi, Lambda).",
        errata=("3.10",),
    )


def _crank_range(ours: Robot) -> ReproducedValue:
    space = ours.workspace
    poses = pose_grid([0.0], (-space.psi, 0.0, space.psi), np.linspace(*space.d, 101))
    crank = np.degrees(inverse_kinematics(ours, poses)[..., 2])
    return fitted(
        "range of the crank angle, psi within 20 deg, d 150 to 250 mm",
        "4.4",
        ("-64.11", "89.63"),
        (float(crank.min()), float(crank.max())),
        "deg",
        Tolerance(absolute=0.01),
        constants="l0 = 200 mm",
        note="l0 is not printed; of both numbers it leaves one to confirm it. l3 = 200 mm is "
        "printed in table 3.1.",
        errata=("table 3.1 l0",),
    )


def _orientation() -> tuple[ReproducedValue, ReproducedValue]:
    pose = np.array(POSE)
    W = np.array(direction(pose))
    phi, psi, _ = POSE
    printed = _pointing(phi, float(np.arcsin(np.sin(psi) / np.cos(phi))))
    x, y, _ = orientation(pose)
    ours, theirs = (float(np.abs(z - W).max()) for z in (_pointing(float(x), float(y)), printed))
    step = 1e-6
    slopes = np.stack(
        [
            (orientation(pose + step * unit) - orientation(pose - step * unit)) / (2 * step)
            for unit in np.eye(3)
        ],
        axis=-1,
    )
    J = orientation_jacobian(pose)
    return (
        claim(
            "direction of the endoscope by the angles of 3.16",
            "3.16",
            "theta_x = phi, theta_y = asin(sin psi/cos phi)",
            "theta_x = asin(sin phi/cos psi), theta_y = psi",
            verdict=PrintVerdict.PRINTED_DIFFERENTLY,
            errata=("3.16",),
            holds=ours < _ROUNDING < theirs,
            note=f"R = Rx Ry must turn z into W of 3.3; as printed it misses by {theirs:.2g} at "
            "phi 0.1, psi -0.2 rad.",
        ),
        claim(
            "Jacobian of these angles",
            "3.17",
            "row of theta_y' first, (0, 1, 0) second",
            "row of theta_x' first, (0, 1, 0) second",
            verdict=PrintVerdict.PRINTED_DIFFERENTLY,
            errata=("3.17",),
            holds=bool(np.abs(J - slopes).max() < 1e-8 < np.abs(J[[1, 0, 2]] - slopes).max()),
            note="theta_y = psi, so its row is (0, 1, 0); phi and psi are exchanged in the other.",
        ),
    )


def _pointing(x: float, y: float) -> Array:
    """Third column of Rx(x) Ry(y)."""
    return np.array([np.sin(y), -np.sin(x) * np.cos(y), np.cos(x) * np.cos(y)])


def _speeds(ours: Robot) -> tuple[ReproducedValue, ...]:
    limits = ours.task_limits
    v = np.array([limits.angular_velocity] * 2 + [limits.linear_velocity])
    depths = np.linspace(*ours.workspace.d, 1001)
    upright = np.stack([0 * depths, 0 * depths, depths], axis=-1)
    crank = np.abs(inverse_jacobian(ours, upright) @ v)[:, 2]
    peaks = joint_peaks(ours, thesis_grid())
    return (
        *_hand(limits.angular_velocity, limits.linear_velocity),
        reproduced(
            "least speed of theta3 over d at phi = psi = 0",
            "3.3",
            "2.0094",
            float(crank.min()),
            "rad/s",
            Tolerance(1e-4),
            note=f"At d = {1e3 * depths[crank.argmin()]:.0f} mm, with the l0 of 4.4.",
            errata=("3.3 speeds",),
        ),
        misprint(
            "largest joint speeds for 0.9687 rad/s and 18.5 mm/s",
            "3.3",
            "2.0094",
            tuple(float(speed) for speed in peaks.velocity),
            "rad/s",
            Tolerance(1e-3),
            right=("1.435", "1.435", "5.129"),
            note="The print is the least speed of theta3 over d, not the largest on the grid of "
            "3.3, phi within 14 and psi within 19 deg.",
            errata=("3.3 speeds",),
        ),
        near(
            "largest joint acceleration",
            "3.3",
            "7.4172",
            ACCELERATION_PER_SPEED * 2.0094,
            "rad/s^2",
            Tolerance(1e-5),
            right="7.43478",
            constants="3.7 1/s",
            because="how it was found is not printed; 3.7 1/s times the printed joint speed only "
            "comes near",
            note=f"The largest on the grid of 3.3 are {_numbers(peaks.acceleration)}.",
        ),
    )


def _hand(angular: float, linear: float) -> tuple[ReproducedValue, ReproducedValue]:
    """Relate the speeds of a surgeon's hand and its accelerations."""
    return (
        reproduced(
            "largest speed of a surgeon's hand",
            "2.4",
            "55.5",
            float(np.degrees(angular)),
            "deg/s",
            Tolerance(1e-4),
        ),
        fitted(
            "largest accelerations of the end-effector",
            "3.3",
            ("3.5840", "68.4500"),
            (ACCELERATION_PER_SPEED * angular, 1e3 * ACCELERATION_PER_SPEED * linear),
            "rad/s^2, mm/s^2",
            Tolerance(1e-4),
            constants="3.7 1/s",
            note="The largest speeds times one factor, which the thesis does not name; of both "
            "numbers it leaves one to confirm it.",
        ),
    )


def _numbers(values: Array) -> str:
    return ", ".join(f"{value:.2f}" for value in values)
