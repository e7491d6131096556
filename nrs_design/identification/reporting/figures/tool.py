"""Figure of an identified tool."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nrs_design.reporting.style import BLUE, INK, VERMILLION, legend, new_figure, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from nrs_design.identification.tool import ToolIdentification


@styled
def draw_errors(found: ToolIdentification) -> Figure:
    """Draw what the fit misses of force and torque in each pose, along each axis."""
    figure = new_figure(4.4)
    above, below = figure.subplots(2, 1, sharex=True)
    poses = np.arange(1, len(found.force_errors) + 1)
    for axes, errors, label in (
        (above, found.force_errors, "Force [N]"),
        (below, found.torque_errors, "Torque [N m]"),
    ):
        axes.axhline(0.0, color=INK, linewidth=0.8)
        for i, (axis, color, mark) in enumerate(
            (("x", BLUE, "o"), ("y", VERMILLION, "s"), ("z", INK, "^"))
        ):
            axes.plot(poses, errors[:, i], mark, color=color, markersize=5.0, label=axis)
        axes.set_ylabel(label)
    below.set_xlabel("Pose")
    below.xaxis.get_major_locator().set_params(integer=True)
    legend(figure, below)
    return figure
