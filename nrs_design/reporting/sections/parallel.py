"""Parallel position and force control: for which stiffness, and how much dead time it bears."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.axis import labelled, unit
from nrs_design.design.parallel import border
from nrs_design.reporting.document import Illustration, Paragraph, Section, Table
from nrs_design.reporting.formatting import number
from nrs_design.reporting.sections.places import linked
from nrs_design.reporting.style import (
    BLUE,
    INK,
    MUTED,
    PURPLE,
    VERMILLION,
    legend,
    new_axes,
    styled,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from nrs_design.design.analysis import DesignAnalysis
    from nrs_design.design.laws.parallel import ParallelAnalysis
    from nrs_design.design.transfer import TransferFunction
    from nrs_design.spec import LoadedSpec

_TEXT = (
    "In constant contact the loop is that of s D + k (Kp s + Ki) N with the motion loop N/D. For "
    "which stiffness it is unstable is decided exactly, by Routh's criterion; ends are rounded "
    "away from what is unstable. Dead time is drawn in floating point. Neither is part of the "
    "proof, which is for stiffness that changes."
)
_CAPTION = (
    "Stable below a border, for that dead time of the force signal. Stiffness and gains count by "
    "their products alone, so a law is a ray from the origin; its dot is at the nominal stiffness, "
    "its end at ten times that."
)


def parallel_section(loaded: LoadedSpec, analysis: DesignAnalysis) -> Section:
    """Describe the parallel controllers."""
    rows = tuple(
        (
            item.name,
            *(
                linked(loaded, text, "controllers", item.name)
                for text in (
                    number(float(item.Kp), 6),
                    number(float(item.Ki), 6),
                    number(item.stiffness, 6),
                    item.unstable_text,
                )
            ),
        )
        for item in analysis.parallel
    )
    columns = (
        "Controller",
        labelled("Kp [rad/(N·m)]"),
        labelled("Ki [rad/(N·m·s)]"),
        labelled("Nominal stiffness [N·m/rad]"),
        labelled("Unstable for k [N·m/rad]"),
    )
    figure = _draw_parallel(analysis.motion, analysis.parallel)
    return Section(
        "Parallel position and force control",
        (
            Paragraph(_TEXT),
            Table("Parallel controllers", columns, rows),
            Illustration("parallel-region", "Region of gains", _CAPTION, figure),
        ),
    )


DELAYS = (0.002, 0.005, 0.01)
_COLOURS = (BLUE, PURPLE, VERMILLION)
_FREQUENCIES = np.geomspace(1e-1, 1e4, 20_000)


@styled
def _draw_parallel(motion: TransferFunction, laws: Sequence[ParallelAnalysis]) -> Figure:
    """Draw the borders of stability in k Kp and k Ki for dead times, and the laws as rays."""
    figure, axes = new_axes(4.2)
    tallest = 0.0
    for delay, colour in zip(DELAYS, _COLOURS, strict=True):
        x, y = _first_border(motion, delay)
        axes.plot(x, y, color=colour, label=f"border at {1e3 * delay:g} ms")
        axes.fill_between(x, 0.0, y, color=colour, alpha=0.08)
        tallest = max(tallest, float(y.max()))
    for law in laws:
        at = law.stiffness * np.array([float(law.Kp), float(law.Ki)])
        axes.plot([0, 10 * at[0]], [0, 10 * at[1]], color=MUTED, linewidth=1.0)
        axes.plot(*at, "o", color=INK, label=f"{law.name} at {law.stiffness:.4g} {unit('N·m/rad')}")
    axes.set_ylim(0.0, 1.1 * tallest)
    axes.set_xlim(left=0.0)
    axes.set(xlabel="k Kp [1]", ylabel="k Ki [1/s]")
    legend(figure, axes, 2)
    return figure


def _first_border(
    motion: TransferFunction, delay: float
) -> tuple[np.ndarray[tuple[int], np.dtype[np.float64]], ...]:
    """Return the border next to the origin: up to where it comes down to k Ki = 0."""
    x, y = border(motion, delay, _FREQUENCIES[_FREQUENCIES * delay < np.pi])
    inside = (x >= 0) & (y >= 0)
    return x[inside], y[inside]
