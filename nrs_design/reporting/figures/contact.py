"""How contact is lost and made again during a run."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nrs_design.reporting.style import BLUE, INK, MUTED, legend, new_axes, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from nrs_design.simulation.norms import Array


@styled
def draw_deflection(time: Array, deflection: Array, label: str, unit_of_time: str) -> Figure:
    """Draw the deflection over time, shaded while there is no contact.

    Parameters
    ----------
    time, deflection : ndarray, shape (N + 1,)
        The run; the deflection relative to its largest value.
    label : str
        Name of the deflection.
    unit_of_time : str
        Of the horizontal axis, such as ``s``.
    """
    figure, axes = new_axes(2.6)
    axes.plot(time, deflection, color=BLUE, label=label)
    axes.axhline(0.0, color=INK, linewidth=0.8)
    axes.fill_between(
        time,
        0,
        1,
        where=(deflection <= 0).tolist(),
        transform=axes.get_xaxis_transform(),
        color=MUTED,
        alpha=0.25,
        linewidth=0,
        label="no contact",
    )
    axes.set_xlabel(f"Time [{unit_of_time}]")
    axes.set_ylabel("Deflection over\nits largest value [1]")
    legend(figure, axes)
    return figure
