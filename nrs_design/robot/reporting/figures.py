"""Figures of a robot: workspace, torques, correction and balance."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.reporting.style import (
    CYCLE,
    INK,
    MUTED,
    color,
    legend,
    marker,
    new_axes,
    new_figure,
    styled,
)
from nrs_design.robot.models.correction import TiltTable
from nrs_design.robot.models.dynamics import torque_shares
from nrs_design.robot.models.geometry import reach_margin
from nrs_design.robot.models.robot import Robot
from nrs_design.robot.models.vectors import Array, root_mean_square
from nrs_design.robot.models.workspace import pose_grid, reachable_poses, thesis_grid

if TYPE_CHECKING:
    from matplotlib.figure import Figure

JOINTS = ("θ1 (left)", "θ2 (right)", "θ3 (middle)")
_POINTS = 121


@styled
def draw_workspace(robot: Robot) -> Figure:
    """Draw how far the legs are from their limits, over phi and psi at three depths.

    White is what some leg cannot reach.
    """
    space = robot.workspace
    phi, psi = (np.linspace(-end, end, _POINTS) for end in (space.phi, space.psi))
    depths = np.linspace(*space.d, 3)
    margins = 1e3 * reach_margin(robot, pose_grid(phi, psi, depths)).min(axis=-1)
    figure = new_figure(3.1)
    panels = figure.subplots(1, 3, sharey=True)
    for index, axes in enumerate(panels):
        visible = np.where(margins[..., index] > 0, margins[..., index], np.nan)
        image = axes.pcolormesh(
            np.degrees(phi),
            np.degrees(psi),
            visible.T,
            vmin=0.0,
            vmax=float(np.nanmax(margins)),
            cmap="viridis",
            rasterized=True,
        )
        axes.grid(visible=False)
        axes.set_title(f"d = {1e3 * depths[index]:.0f} mm", fontsize=10)
        axes.set_xlabel("φ [deg]")
    panels[0].set_ylabel("ψ [deg]")
    figure.colorbar(image, ax=panels, label="Least reach margin [mm]", shrink=0.95)
    return figure


@styled
def draw_torque_shares(robot: Robot, depths: Sequence[float] = (0.15, 0.2, 0.24)) -> Figure:
    """Draw the mean shares of gravity, velocities and accelerations (thesis fig. 3.8)."""
    figure, axes = new_axes(4.0)
    names = ("gravity", "Coriolis and centripetal", "inertia")
    positions = [4 * row + column for row in range(len(depths)) for column in range(3)]
    parts = [
        torque_shares(robot, reachable_poses(robot, thesis_grid((depth,)))) for depth in depths
    ]
    bottom = np.zeros(len(positions))
    for index, key in enumerate(("gravity", "coriolis", "inertia")):
        means = np.concatenate([100 * getattr(part, key).mean(axis=0) for part in parts])
        bars = axes.bar(positions, means, bottom=bottom, color=color(index), label=names[index])
        # A thin bar has no room for its number.
        labels = [f"{mean:.0f}" if mean >= 3.5 else "" for mean in means]
        axes.bar_label(bars, labels, label_type="center", fontsize=8, color="white")
        bottom += means
    axes.set_xticks(positions, [f"θ{column + 1}" for _ in depths for column in range(3)])
    for row, depth in enumerate(depths):
        axes.annotate(
            f"d = {1e3 * depth:.0f} mm",
            (4 * row + 1, 0),
            (0, -28),
            textcoords="offset points",
            ha="center",
            va="top",
        )
    axes.grid(visible=False, axis="x")
    axes.set_ylabel("Mean share of the torque [%]")
    axes.set_ylim(0, 100)
    axes.set_xlabel(" ", labelpad=14)
    legend(figure, axes, 3)
    return figure


@styled
def draw_correction(depth: TiltTable, angle_table: TiltTable) -> Figure:
    """Draw the correction coefficients against the tilt of the base (thesis fig. 3.12).

    Mean ratios over motions of the depth, and least squares over motions of the angles too.
    """
    figure, axes = new_axes(4.0)
    tilt = np.degrees(depth.tilt)
    step = max(1, len(tilt) // 8)
    for joint, name in enumerate(JOINTS):
        axes.plot(
            tilt,
            depth.mean_ratio[:, joint],
            color=color(joint),
            marker=marker(joint),
            # An offset for each joint, so that coinciding curves show all markers.
            markevery=(joint * step // len(JOINTS), step),
            markersize=5,
            label=f"{name}, depth only, mean ratio",
        )
        axes.plot(
            np.degrees(angle_table.tilt),
            angle_table.least_squares[:, joint],
            color=color(joint),
            linestyle=(0, (3, 3)),
            linewidth=1.2,
            label=f"{name}, with angles, least squares",
        )
    axes.set_xlabel("Tilt of the base θ4 [deg]")
    axes.set_ylabel("Correction coefficient [-]")
    legend(figure, axes, 2)
    return figure


@styled
def draw_balance(gravity: Array, residual: Array) -> Figure:
    """Draw what the motors hold with and without balance: root mean square and largest torque."""
    figure, axes = new_axes(3.6)
    positions = np.arange(3)
    for index, (name, torque) in enumerate((("without", gravity), ("with balance", residual))):
        rms = root_mean_square(torque)
        place = positions + 0.4 * index - 0.2
        bars = axes.bar(place, rms, 0.36, color=CYCLE[index], label=f"{name}, root mean square")
        axes.bar_label(bars, fmt="%.2f", label_type="center", fontsize=9, color="white")
        axes.plot(
            place,
            np.abs(torque).max(axis=0),
            marker=marker(index),
            linestyle="none",
            color=(INK, MUTED)[index],
            label=f"{name}, largest",
        )
    axes.set_xticks(positions, JOINTS)
    axes.grid(visible=False, axis="x")
    axes.set_ylabel("Static torque [N·m]")
    axes.set_ylim(0, None)
    legend(figure, axes, 2)
    return figure
