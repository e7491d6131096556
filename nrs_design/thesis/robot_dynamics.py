"""Chapters 3.2 and 3.3: what the torque is made of, and the simplified model."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from nrs_design.robot.models.body import slender_rod
from nrs_design.robot.models.correction import TABLE_3_5, correction_coefficients
from nrs_design.robot.models.dynamics import mass_matrix, torque_shares
from nrs_design.robot.models.neuroboscope import robot
from nrs_design.robot.models.simplified import simplified_dynamics
from nrs_design.robot.models.workspace import thesis_grid
from nrs_design.thesis import thesis
from nrs_design.thesis.comparison import Found, Recomputed


def results() -> Iterator[Found]:
    """Recompute torque shares and inertia ratios, and what the place of the platform does."""
    ours = robot()
    poses = thesis_grid()
    yield tuple(100 * share for share in torque_shares(ours, poses).means)
    # The 36.7 mm of table 3.1, read both ways.
    lateral, axial = (
        float(
            correction_coefficients(
                replace(ours, platform=slender_rod(ours.platform.mass, place, 0.25, 2)),
                TABLE_3_5[0],
            ).mean_ratio[0]
        )
        for place in ((0.0367, 0.0, 0.010), (0.0, 0.0, 0.0367))
    )
    yield Recomputed((lateral, axial), abs(lateral - 1.8318) < 0.1 * abs(axial - 1.8318))
    right = simplified_dynamics(ours, poses).Ms
    printed = simplified_dynamics(ours, poses, printed=True).Ms
    scale = np.abs(right).max(axis=(-1, -2), keepdims=True)
    worst = float((np.abs(printed - right) / scale).max())
    yield Recomputed(None, 1e-4 < worst < 1e-2, (f"{100 * worst:.2g}",))
    reflected = 1 / (905**2 * thesis.MOTOR.inertia)
    full = float(mass_matrix(ours, ours.home)[0, 0])
    facts = (f"{full:.4f}", f"{100 * full * reflected:.1f}")
    yield Recomputed(100 * 0.055 * reflected, facts=facts)
