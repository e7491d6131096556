"""Figures in the complex plane: root loci and eigenvalues."""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from nrs_design.design.transfer import TransferFunction, poles, to_control
from nrs_design.proof.evidence.fields import rate_words
from nrs_design.proof.mode import Time
from nrs_design.reporting.figures.view import show_disk, show_half_plane
from nrs_design.reporting.style import (
    ALARM,
    BLUE,
    INK,
    MUTED,
    TOLD_APART,
    VERMILLION,
    color,
    legend,
    marker,
    new_axes,
    styled,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

Complexes = Sequence[complex]


@styled
def draw_root_locus(open_loop: TransferFunction, wanted: Complexes, reached: Complexes) -> Figure:
    """Draw the closed-loop poles in rad/s over the gain."""
    from nrs_design.control_library import control

    figure, axes = new_axes(4.0)
    start = poles(open_loop)
    zeros = np.roots(open_loop.numerator)
    points = np.concatenate([start, zeros, np.asarray(wanted), np.asarray(reached)])
    for branch in control.root_locus_map(to_control(open_loop)).loci.T:
        axes.plot(branch.real, branch.imag, color=BLUE, zorder=2)
    axes.plot(start.real, start.imag, "x", color=INK, markersize=8, label="open-loop poles")
    if len(zeros):
        axes.plot(zeros.real, zeros.imag, "o", color=INK, mfc="none", label="open-loop zeros")
    if wanted:
        _mark(axes, wanted, "s", VERMILLION, "wanted poles", size=11, filled=False)
    _mark(axes, reached, "D", VERMILLION, "poles reached", size=5.5, filled=True)
    show_half_plane(axes, points, "rad/s", room=0.35)
    legend(figure, axes, 2)
    return figure


@styled
def draw_eigenvalues(
    names: Sequence[str],
    values: Sequence[NDArray[np.complex128]],
    time: Time,
    rate: Fraction | None,
) -> Figure:
    """Draw the eigenvalues of all modes with the border of stability.

    They are in 1/s in continuous time; the proved rate is a second border. More than 24 modes are
    drawn alike.
    """
    figure, axes = new_axes(4.2)
    together = np.concatenate(list(values))
    _border(axes, time, rate)
    for index, (name, row) in enumerate(zip(names, values, strict=True)):
        label, look = _look(index, name, len(names))
        axes.plot(row.real, row.imag, mfc="none", label=label, linestyle="none", **look)
    unstable = together[_outside(together, time)]
    if len(unstable):
        _mark(axes, unstable.tolist(), "o", ALARM, "not in the stable region", 17, filled=False)
    if time is Time.CONTINUOUS:
        show_half_plane(axes, together, "1/s")
        right = axes.get_xlim()[1]
        axes.axvspan(0.0, right, color=VERMILLION, alpha=0.17, zorder=0, linewidth=0)
    else:
        show_disk(axes, together, "1")
    legend(figure, axes, 2)
    return figure


def _look(index: int, name: str, count: int) -> tuple[str | None, dict[str, Any]]:
    """Return label and look of a mode; markers of several sizes show where modes coincide."""
    if count > TOLD_APART:
        label = f"eigenvalues of {count} modes, drawn alike" if index == 0 else None
        return label, {"color": BLUE, "marker": "o"}
    size = 5.0 + 1.8 * (index % 3)
    return name, {"color": color(index), "marker": marker(index), "markersize": size}


def _outside(values: NDArray[np.complex128], time: Time) -> NDArray[np.bool_]:
    if time is Time.CONTINUOUS:
        return np.asarray(values.real >= -1e-9 * np.abs(values).max())
    return np.asarray(np.abs(values) >= 1 - 1e-9)


def _border(axes: Axes, time: Time, rate: Fraction | None) -> None:
    if time is Time.CONTINUOUS:
        axes.axvline(0.0, color=INK, linewidth=1.0)
        if rate is not None:
            label = f"-alpha, {rate_words(rate, time)}"
            axes.axvline(-float(rate), color=MUTED, linewidth=1.2, linestyle="--", label=label)
        return
    angle = np.linspace(0, 2 * math.pi, 361)
    axes.plot(np.cos(angle), np.sin(angle), color=INK, linewidth=1.0, label="unit circle")
    if rate is not None:
        x, y = float(rate) * np.cos(angle), float(rate) * np.sin(angle)
        label = rate_words(rate, time)
        axes.plot(x, y, color=MUTED, linewidth=1.2, linestyle="--", label=label)


def _mark(
    axes: Axes, values: Complexes, shape: str, tint: str, label: str, size: float, *, filled: bool
) -> None:
    x, y = [z.real for z in values], [z.imag for z in values]
    fill = tint if filled else "none"
    axes.plot(x, y, shape, color=tint, mfc=fill, markersize=size, label=label, zorder=4)
