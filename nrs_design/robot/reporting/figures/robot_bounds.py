"""What the links of a robot do to its axes over a workspace, beside the bounds that are shown."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.reporting.style import new_figure, styled
from nrs_design.robot.models import Enclosed, Robot, Space, bound_text, pose_grid, values_at

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_POINTS, _DEPTHS = 41, 9
_TITLES = {
    "heaviest": "largest eigenvalue of M\n[kg m²]",
    "lightest": "smallest eigenvalue of M\n[kg m²]",
    "velocity_torques": "Coriolis torque / speed²\n[N m s²/rad²]",
    "gravity_gradient": "gradient of gravity torque\n[N m/rad]",
}


@styled
def draw_bounds(robot: Robot, space: Space, found: Mapping[str, Enclosed]) -> Figure:
    """Draw the worst of each quantity over the depth, over phi and psi, and where it is worst.

    Parameters
    ----------
    robot : Robot
        The robot.
    space : Space
        The poses.
    found : mapping
        As `nrs_design.robot.models.compute_bounds` gives it.
    """
    whole = space.workspace
    phi, psi = (np.linspace(-end, end, _POINTS) for end in (whole.phi, whole.psi))
    poses = pose_grid(phi, psi, np.linspace(*whole.d, _DEPTHS))
    figure = new_figure(6.0)
    panels = figure.subplots(2, 2, sharex=True, sharey=True)
    for axes, (key, item) in zip(panels.flat, found.items(), strict=True):
        values = values_at(robot, item.quantity, poses).max(axis=-1)
        if key == "lightest":
            values = 1 / values
        image = axes.pcolormesh(
            np.degrees(phi), np.degrees(psi), values.T, cmap="viridis", rasterized=True
        )
        axes.plot(
            *np.degrees(item.pose[:2]),
            "o",
            markerfacecolor="white",
            markeredgecolor="black",
            clip_on=False,
        )
        axes.grid(visible=False)
        side = "never below" if key == "lightest" else "never above"
        axes.set_title(f"{_TITLES[key]}\n{side} {bound_text(key, item)}", fontsize=9)
        figure.colorbar(image, ax=axes)
    for axes in panels[-1]:
        axes.set_xlabel("φ [deg]")
    for axes in panels[:, 0]:
        axes.set_ylabel("ψ [deg]")
    return figure
