"""Figures in the complex plane: root loci and eigenvalues."""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.certificates.evidence.fields import rate_words
from nrs_design.design.root_locus import locus_gains, root_locus
from nrs_design.design.transfer import TransferFunction, poles
from nrs_design.reporting.style import (
    ALARM,
    BLUE,
    INK,
    MUTED,
    VERMILLION,
    color,
    legend,
    marker,
    new_axes,
    short,
    styled,
)
from nrs_design.switched.system import Time

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

Complexes = Sequence[complex]


@styled
def draw_root_locus(
    open_loop: TransferFunction, gain: float, wanted: Complexes, reached: Complexes
) -> Figure:
    """Draw the closed-loop poles over the gain.

    Parameters
    ----------
    open_loop : TransferFunction
        At unit gain.
    gain : float
        The gain in use; it scales the range of gains.
    wanted, reached : sequence of complex
        Poles to mark, in rad/s; `wanted` may be empty.
    """
    figure, axes = new_axes(4.4)
    start = poles(open_loop)
    zeros = np.roots(open_loop.numerator)
    points = np.concatenate([start, zeros, np.asarray(wanted), np.asarray(reached)])
    _limit(axes, points, room=0.35)
    for branch in root_locus(open_loop, locus_gains(open_loop, gain)).T:
        axes.plot(branch.real, branch.imag, color=BLUE, zorder=2)
    axes.plot(start.real, start.imag, "x", color=INK, markersize=8, label="open-loop poles")
    if len(zeros):
        axes.plot(zeros.real, zeros.imag, "o", color=INK, mfc="none", label="open-loop zeros")
    if wanted:
        _mark(axes, wanted, "s", VERMILLION, "wanted poles", size=11, filled=False)
    _mark(axes, reached, "D", VERMILLION, "poles reached", size=5.5, filled=True)
    _finish(axes)
    legend(figure, axes, 4)
    return figure


@styled
def draw_eigenvalues(
    names: Sequence[str],
    values: Sequence[NDArray[np.complex128]],
    time: Time,
    rate: Fraction | None,
) -> Figure:
    """Draw the eigenvalues of all modes with the border of stability.

    Parameters
    ----------
    names : sequence of str
        Of the modes; more than eight are drawn alike.
    values : sequence of ndarray of complex
        Eigenvalues of each mode, in 1/s in continuous time.
    time : Time
        Decides the border: imaginary axis or unit circle.
    rate : Fraction or None
        The proved rate, drawn as a second border.
    """
    figure, axes = new_axes(4.6)
    together = np.concatenate(list(values))
    _border(axes, together, time, rate)
    for index, (name, row) in enumerate(zip(names, values, strict=True)):
        many = len(names) > 8
        tint, shape = (BLUE, "o") if many else (color(index), marker(index))
        label = None if many else short(name)
        axes.plot(row.real, row.imag, shape, color=tint, mfc="none", label=label)
    unstable = together[_outside(together, time)]
    if len(unstable):
        _mark(axes, unstable.tolist(), "o", ALARM, "not in the stable region", 15, filled=False)
    _finish(axes, "1/s" if time is Time.CONTINUOUS else "1")
    legend(figure, axes, 2)
    return figure


def _outside(values: NDArray[np.complex128], time: Time) -> NDArray[np.bool_]:
    if time is Time.CONTINUOUS:
        return np.asarray(values.real >= -1e-9 * np.abs(values).max())
    return np.asarray(np.abs(values) >= 1 - 1e-9)


def _border(axes: Axes, values: NDArray[np.complex128], time: Time, rate: Fraction | None) -> None:
    if time is Time.CONTINUOUS:
        _limit(axes, np.append(values, 0.0))
        right = axes.get_xlim()[1]
        axes.axvspan(0.0, right, color="#f6e3da", zorder=0, linewidth=0)
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
    axes.set_aspect("equal", adjustable="datalim")


def _mark(
    axes: Axes, values: Complexes, shape: str, tint: str, label: str, size: float, *, filled: bool
) -> None:
    x, y = [z.real for z in values], [z.imag for z in values]
    fill = tint if filled else "none"
    axes.plot(x, y, shape, color=tint, mfc=fill, markersize=size, label=label, zorder=4)


def _limit(axes: Axes, points: NDArray[np.complex128], room: float = 0.12) -> None:
    """Show all points with some room around them, as a fraction of their extent."""
    size = float(np.abs(points).max()) or 1.0
    left, right = float(points.real.min()), float(points.real.max())
    height = max(float(np.abs(points.imag).max()), 0.15 * size)
    side = max(right - left, 0.3 * size)
    axes.set_xlim(left - room * side, max(right, 0.0) + 0.12 * side)
    axes.set_ylim(-(1.2 + room) * height, (1.2 + room) * height)


def _finish(axes: Axes, unit: str = "rad/s") -> None:
    axes.axhline(0.0, color=MUTED, linewidth=0.8, zorder=1)
    axes.set_xlabel(f"Real part [{unit}]")
    axes.set_ylabel(f"Imaginary part [{unit}]")
