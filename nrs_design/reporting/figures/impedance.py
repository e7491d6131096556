"""Impedance design over frequency: what the robot displays, and how sensitive the loop is."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.design.measures import IMPEDANCE_ERROR, SENSITIVITY_PEAK
from nrs_design.reporting.style import (
    INK,
    MUTED,
    color,
    curve,
    legend,
    marker,
    new_axes,
    styled,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from nrs_design.design.analysis import ImpedanceAnalysis
    from nrs_design.design.loops import Loops
    from nrs_design.design.transfer import FloatArray

_POINTS = 400


@styled
def draw_displayed_impedance(items: Sequence[ImpedanceAnalysis]) -> Figure:
    """Draw the magnitude of the displayed impedance beside the desired one.

    Parameters
    ----------
    items : sequence of ImpedanceAnalysis
        One curve for each controller, in nominal contact.
    """
    figure, axes = new_axes(3.9)
    omega = _frequencies(items)
    for index, item in enumerate(items):
        nominal = item.requirement.nominal[0]
        shown = item.requirement.displayed(nominal, item.Mt, item.Bt, omega)
        if shown is not None:
            look = curve(index, len(items), len(omega))
            axes.loglog(omega, np.abs(shown), label=f"{item.name}, displayed", **look)
    for desired, names in _wanted(items).items():
        index = next(i for i, item in enumerate(items) if item.name == names[0])
        axes.axhline(
            desired,
            color=color(index) if len(names) == 1 else INK,
            linestyle=(0, (5, 3)),
            linewidth=1.3,
            label=f"{' and '.join(names)}, desired" if len(names) < len(items) else "desired",
        )
    low = min(axes.get_ylim()[0], *(float(item.problem.desired) for item in items))
    for index, item in enumerate(items):
        factor, desired = band_factor(item), float(item.problem.desired)
        axes.fill_between(
            [omega[0], item.problem.bandwidth],
            desired / factor,
            desired * factor,
            color=color(index),
            alpha=0.2,
            linewidth=0,
            label=f"{item.name}, within a factor of {factor:.3g}",
        )
    axes.set_ylim(low, None)
    _finish(axes, items, "Impedance magnitude [N·m·s/rad]")
    legend(figure, axes)
    return figure


@styled
def draw_sensitivity(items: Sequence[ImpedanceAnalysis]) -> Figure:
    """Draw the magnitude of the sensitivity where its peak Ms is worst, a curve a controller."""
    figure, axes = new_axes(3.9)
    omega = _frequencies(items)
    for index, item in enumerate(items):
        worst, loops = item.worst(SENSITIVITY_PEAK), _worst_loops(item)
        magnitude = np.abs(1 / (1 + loops.response(omega)[0]))
        peak, at = worst.value, float(loops.peak_frequency()[0])
        label = f"{item.name}, Ms = {worst.measure.text(peak)}"
        axes.loglog(omega, magnitude, label=label, **curve(index, len(items), len(omega)))
        if math.isfinite(at) and math.isfinite(peak):
            axes.plot(
                at, peak, marker(index), color=color(index), markeredgecolor=INK, markersize=8
            )
    axes.axhline(1.0, color=MUTED, linewidth=1.0)
    _finish(axes, items, "Sensitivity magnitude |L| [1]")
    legend(figure, axes)
    return figure


def _worst_loops(item: ImpedanceAnalysis) -> Loops:
    """Return the open loop at the corner where Ms is worst."""
    corner = item.requirement.corner(item.worst(SENSITIVITY_PEAK).where)
    return item.requirement.loops(corner, np.array([item.Mt]), np.array([item.Bt]))


def band_factor(item: ImpedanceAnalysis) -> float:
    """Return by which factor the displayed impedance may be off: the goal, or what is usual."""
    goals = (f.goal for f in item.achieved if f.measure is IMPEDANCE_ERROR and f.goal)
    return next(goals, IMPEDANCE_ERROR.doubtful or 2.0)


def _wanted(items: Sequence[ImpedanceAnalysis]) -> dict[float, list[str]]:
    """Return the controllers that ask for each impedance: lines that coincide are one line."""
    found: dict[float, list[str]] = {}
    for item in items:
        found.setdefault(float(item.problem.desired), []).append(item.name)
    return found


def _frequencies(items: Sequence[ImpedanceAnalysis]) -> FloatArray:
    """Return frequencies in rad/s from far below the bandwidth to beyond it and every peak."""
    bandwidth = items[0].problem.bandwidth
    peaks = [float(_worst_loops(item).peak_frequency()[0]) for item in items]
    highest = 10 * max([bandwidth, *(peak for peak in peaks if math.isfinite(peak))])
    period = _worst_loops(items[0]).period
    return np.geomspace(
        bandwidth / 100, min(highest, math.pi / (period or math.pi / highest)), _POINTS
    )


def _finish(axes: Axes, items: Sequence[ImpedanceAnalysis], ylabel: str) -> None:
    bandwidth = items[0].problem.bandwidth
    label = f"bandwidth {bandwidth / (2 * math.pi):.3g} Hz"
    axes.axvline(bandwidth, color=MUTED, linewidth=1.4, linestyle=":", label=label)
    axes.set_xlabel("Frequency [rad/s]")
    axes.set_ylabel(ylabel)
    axes.set_xlim(bandwidth / 100, None)
