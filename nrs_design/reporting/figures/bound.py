"""An output under a disturbance, between the bounds that it cannot cross."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nrs_design.reporting.style import (
    BLUE,
    GREEN,
    INK,
    MUTED,
    VERMILLION,
    legend,
    new_axes,
    styled,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from nrs_design.simulation.norms import Array


@styled
def draw_bound(
    time: Array,
    output: Array,
    level: float,
    limit: float | None,
    label: str,
    unit_of_time: str,
) -> Figure:
    """Draw an output over time, the level that is proved and the limit that it is meant to keep.

    Parameters
    ----------
    time : ndarray, shape (N + 1,)
        The run.
    output : ndarray, shape (N + 1, r)
        The output for every row of it.
    level : float
        Proved bound on its size.
    limit : float or None
        What its size is meant to keep.
    label : str
        Name and unit of the output.
    unit_of_time : str
        Of the horizontal axis, such as ``s``.
    """
    figure, axes = new_axes(3.6)
    axes.fill_between(time, output.min(axis=1), output.max(axis=1), color=BLUE, alpha=0.25)
    axes.plot(time, output[:, 0], color=BLUE, label="simulated run")
    axes.axhline(0.0, color=MUTED, linewidth=0.8)
    for sign in (1.0, -1.0):
        first = sign > 0
        axes.axhline(
            sign * level, color=VERMILLION, linestyle="--", label="proved bound" if first else None
        )
        if limit is not None:
            axes.axhline(
                sign * limit,
                color=GREEN,
                linestyle=":",
                label="limit of the spec" if first else None,
            )
    axes.set_xlabel(f"Time [{unit_of_time}]", color=INK)
    axes.set_ylabel(label)
    legend(figure, axes, 3)
    return figure
