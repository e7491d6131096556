"""Where parallel control is stable: one map for every stiffness, with the laws as rays."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.design.parallel import border
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

    from nrs_design.design.laws.parallel import ParallelAnalysis
    from nrs_design.design.transfer import TransferFunction

DELAYS = (0.002, 0.005, 0.01)
_COLOURS = (BLUE, PURPLE, VERMILLION)
_FREQUENCIES = np.geomspace(1e-1, 1e4, 20_000)


@styled
def draw_parallel(motion: TransferFunction, laws: Sequence[ParallelAnalysis]) -> Figure:
    """Draw the borders of stability in k Kp and k Ki for dead times, and the laws as rays.

    Parameters
    ----------
    motion : TransferFunction
        Motion loop G.
    laws : sequence of ParallelAnalysis
        Each from no stiffness to ten times the nominal one, which is marked.
    """
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
        axes.plot(*at, "o", color=INK, label=f"{law.name} at {law.stiffness:.4g} N·m/rad")
    axes.set_ylim(0.0, 1.1 * tallest)
    axes.set_xlim(left=0.0)
    axes.set_xlabel("k Kp [1]")
    axes.set_ylabel("k Ki [1/s]")
    legend(figure, axes, 2)
    return figure


def _first_border(
    motion: TransferFunction, delay: float
) -> tuple[np.ndarray[tuple[int], np.dtype[np.float64]], ...]:
    """Return the border next to the origin: up to where it comes down to k Ki = 0."""
    x, y = border(motion, delay, _FREQUENCIES[_FREQUENCIES * delay < np.pi])
    inside = (x >= 0) & (y >= 0)
    return x[inside], y[inside]
