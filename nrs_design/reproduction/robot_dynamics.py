"""Chapters 3.2 and 3.3: what the torque is made of, and the simplified model."""

from __future__ import annotations

import numpy as np

from nrs_design.models.robot import (
    Robot,
    mass_matrix,
    simplified_dynamics,
    thesis_grid,
    torque_shares,
)
from nrs_design.reproduction import thesis
from nrs_design.reproduction.comparison import (
    ReproducedValue,
    Tolerance,
    derived,
    omitted,
    reproduced,
)
from nrs_design.reproduction.neuroboscope import robot

_FIGURE = "The trajectory of figure 3.7 is not in the text."
# Quantity, section, print, unit.
NEEDS_THE_FIGURE = (
    ("torque error against Simscape", "3.2", "0.0014, 0.0018, 2.6251e-5", "%"),
    (
        "torque RMSE, model under the same assumptions",
        "table 3.2",
        "6.76e-5, 1.135e-4, 6.11e-5",
        "N m",
    ),
    ("torque RMSE, with all inertias", "table 3.3", "3.789e-4, 1.965e-4, 3.185e-4", "N m"),
    ("torque RMSE, full model", "table 3.4", "1.4691, 1.5350, 1.5475", "N m"),
    ("torque RMSE with correction coefficients", "table 3.6", "0.0215, 0.0206, 0.0270", "N m"),
    ("largest torques", "3.4", "3.5639, 3.6804, 2.8990", "N m"),
    ("torque RMSE at theta4 = -10, -40, -70 deg", "table 3.7", "0.0154 to 0.0807", "N m"),
    ("largest torques at theta4 = -10, -40, -70 deg", "table 3.7", "1.3330 to 4.3234", "N m"),
)


def rows() -> tuple[ReproducedValue, ...]:
    """Recompute torque shares and inertia ratios, and list what lacks its trajectory."""
    return (
        _shares(robot()),
        _angular_velocity(robot()),
        *_inertia_ratio(robot()),
        *(omitted(*numbers, _FIGURE) for numbers in NEEDS_THE_FIGURE),
    )


def _shares(ours: Robot) -> ReproducedValue:
    means = torque_shares(ours, thesis_grid()).means
    return reproduced(
        "torque shares of gravity, Coriolis and inertia",
        "3.3",
        ("75.5", "11.5", "13"),
        tuple(100 * share for share in means),
        "%",
        Tolerance(absolute=0.1),
        note="All joints at 2.0094 rad/s and 7.4172 rad/s^2; mean over joints, over phi within 14 "
        "and psi within 19 deg by 1 deg, and over d = 150, 200, 240 mm.",
    )


def _angular_velocity(ours: Robot) -> ReproducedValue:
    poses = thesis_grid()
    right = simplified_dynamics(ours, poses).Ms
    printed = simplified_dynamics(ours, poses, printed=True).Ms
    scale = np.abs(right).max(axis=(-1, -2), keepdims=True)
    worst = float((np.abs(printed - right) / scale).max())
    return derived(
        "angular velocity of the platform",
        "3.33",
        "(theta_x', cos(theta_x) theta_y', sin(theta_x) theta_y')",
        printed="(theta_x', theta_y', 0)",
        holds=1e-4 < worst < 1e-2,
        note=f"The print is an approximation: it changes Ms by at most {100 * worst:.2g} % of its "
        "largest entry.",
    )


def _inertia_ratio(ours: Robot) -> tuple[ReproducedValue, ...]:
    reflected = 1 / (905**2 * thesis.MOTOR.inertia)
    full = float(mass_matrix(ours, ours.home)[0, 0])
    return (
        reproduced(
            "inertia of the robot beside that of the motor, I_L/N^2 over I_r",
            "4.3",
            "4",
            100 * 0.055 * reflected,
            "%",
            Tolerance(1e-3),
            right="4.534",
            note="The thesis says approximately. With the full M11 of "
            f"{full:.4f} kg m^2 at d = 200 mm it is {100 * full * reflected:.1f} %.",
        ),
    )
