"""Chapters 3.2 and 3.3: what the torque is made of, and the simplified model."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from nrs_design.robot.models import (
    Robot,
    correction_coefficients,
    mass_matrix,
    simplified_dynamics,
    thesis_grid,
    torque_shares,
)
from nrs_design.robot.models.body import slender_rod
from nrs_design.robot.models.correction import TABLE_3_5
from nrs_design.robot.models.neuroboscope import robot
from nrs_design.thesis import thesis
from nrs_design.thesis.comparison import (
    ReproducedValue,
    Tolerance,
    derived,
    fitted,
    reproduced,
)
from nrs_design.thesis.correction import AXIAL


def rows() -> tuple[ReproducedValue, ...]:
    """Recompute torque shares and inertia ratios, and what the place of the platform does."""
    return (
        _shares(robot()),
        _platform(robot()),
        _angular_velocity(robot()),
        *_inertia_ratio(robot()),
    )


def _shares(ours: Robot) -> ReproducedValue:
    means = torque_shares(ours, thesis_grid()).means
    return fitted(
        "torque shares of gravity, Coriolis and inertia",
        "3.3",
        ("75.5", "11.5", "13"),
        tuple(100 * share for share in means),
        "%",
        Tolerance(1e-3),
        right=("75.512", "11.454", "13.034"),
        constants=AXIAL,
        note="Not printed: that all joints are at 2.0094 rad/s and 7.4172 rad/s^2, and how the "
        "shares are averaged: over joints, over phi within 14 and psi within 19 deg by 1 deg, and "
        "over d = 150, 200, 240 mm. With 6 mm they are 75.7, 11.4, 12.9 %.",
        errata=("3.3 shares",),
    )


def _platform(ours: Robot) -> ReproducedValue:
    """Read the 36.7 mm of table 3.1 both ways."""
    lateral, axial = (
        float(
            correction_coefficients(
                replace(ours, platform=slender_rod(ours.platform.mass, place, 0.25, 2)),
                TABLE_3_5[0],
            ).mean_ratio[0]
        )
        for place in ((0.0367, 0.0, 0.010), (0.0, 0.0, 0.0367))
    )
    return derived(
        "K_corr,1 with the platform's 36.7 mm lateral, axial",
        "table 3.1",
        (lateral, axial),
        printed="1.8318 in table 3.5",
        right=("1.82288", "1.73589"),
        tolerance=Tolerance(1e-4),
        holds=abs(lateral - 1.8318) < 0.1 * abs(axial - 1.8318),
        note="Table 3.1 does not say in which direction the 36.7 mm are: towards the middle leg.",
        errata=("table 3.1 36.7 mm",),
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
        errata=("3.33",),
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
            errata=("4.3 inertia",),
        ),
    )
