"""Figures in the complex plane: root loci and eigenvalues, the many not squeezed by a few."""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from nrs_design.design.transfer import TransferFunction, poles, to_control
from nrs_design.proof.evidence.fields import rate_words
from nrs_design.proof.mode import Time
from nrs_design.reporting.style import (
    ALARM,
    BLUE,
    INK,
    MAX_SERIES,
    MUTED,
    VERMILLION,
    color,
    format_tick,
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
def draw_root_locus(
    open_loop: TransferFunction, target_poles: Complexes, closed_loop_poles: Complexes
) -> Figure:
    """Draw the closed-loop poles in rad/s over the gain."""
    from nrs_design.control_library import control

    figure, axes = new_axes(4.0)
    start = poles(open_loop)
    zeros = np.roots(open_loop.numerator)
    points = np.concatenate([start, zeros, np.asarray(target_poles), np.asarray(closed_loop_poles)])
    for branch in control.root_locus_map(to_control(open_loop)).loci.T:
        axes.plot(branch.real, branch.imag, color=BLUE, zorder=2)
    axes.plot(start.real, start.imag, "x", color=INK, markersize=8, label="open-loop poles")
    if len(zeros):
        axes.plot(zeros.real, zeros.imag, "o", color=INK, mfc="none", label="open-loop zeros")
    if target_poles:
        _mark(axes, target_poles, "s", VERMILLION, "wanted poles", size=11, filled=False)
    _mark(axes, closed_loop_poles, "D", VERMILLION, "poles reached", size=5.5, filled=True)
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
    eigenvalues = np.concatenate(list(values))
    _border(axes, time, rate)
    for index, (name, row) in enumerate(zip(names, values, strict=True)):
        label, look = _look(index, name, len(names))
        axes.plot(row.real, row.imag, mfc="none", label=label, linestyle="none", **look)
    unstable = eigenvalues[_find_unstable(eigenvalues, time)]
    if len(unstable):
        _mark(axes, unstable.tolist(), "o", ALARM, "not in the stable region", 17, filled=False)
    if time is Time.CONTINUOUS:
        show_half_plane(axes, eigenvalues, "1/s")
        right = axes.get_xlim()[1]
        axes.axvspan(0.0, right, color=VERMILLION, alpha=0.17, zorder=0, linewidth=0)
    else:
        show_disk(axes, eigenvalues, "1")
    legend(figure, axes, 2)
    return figure


def _look(index: int, name: str, count: int) -> tuple[str | None, dict[str, Any]]:
    """Return label and look of a mode; markers of several sizes show where modes coincide."""
    if count > MAX_SERIES:
        label = f"eigenvalues of {count} modes, drawn alike" if index == 0 else None
        return label, {"color": BLUE, "marker": "o"}
    size = 5.0 + 1.8 * (index % 3)
    return name, {"color": color(index), "marker": marker(index), "markersize": size}


def _find_unstable(values: NDArray[np.complex128], time: Time) -> NDArray[np.bool_]:
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


# A value this many times beyond the next one, and beyond most, lies far.
_FAR = 10.0
# Length of the linear part of a half axis, relative to its logarithmic part.
_LINEAR_SHARE = 1.5
_DECADES = 3


def show_half_plane(
    axes: Axes, points: NDArray[np.complex128], unit: str, room: float = 0.12
) -> None:
    """Show points with some room around them, as a fraction of their extent, and the origin."""
    x, y = np.append(points.real, 0.0), points.imag
    tiny = 1e-9 * float(np.abs(points).max())
    ends = _near_end(x, tiny), _near_end(y, tiny)
    near_x, near_y = (np.clip(v, -end, end) for v, end in zip((x, y), ends, strict=True))
    size = float(max(np.abs(near_x).max(), np.abs(near_y).max())) or 1.0
    left, right = float(near_x.min()), float(near_x.max())
    side = max(right - left, 0.3 * size)
    top = (1.2 + room) * max(float(np.abs(near_y).max()), 0.15 * size)
    _set_axis(axes, "x", unit, x, (left - room * side, right + 0.12 * side), ends[0])
    _set_axis(axes, "y", unit, y, (-top, top), ends[1])


def show_disk(axes: Axes, points: NDArray[np.complex128], unit: str) -> None:
    """Show points and the unit circle, which is kept round."""
    far = max(1.0, float(np.abs(points.real).max()), float(np.abs(points.imag).max()))
    end = _near_end(np.concatenate([points.real, points.imag, np.ones(2 * len(points) + 1)]), 0.0)
    for name in "xy":
        limits = (-1.12 * far, 1.12 * far)
        _set_axis(axes, name, unit, np.array([-far, far]), limits, max(end, 1.2))
    axes.set_box_aspect(1)


def _near_end(values: NDArray[np.float64], tiny: float) -> float:
    """Return up to where an axis is linear: without end where no value lies far beyond others."""
    sizes = np.sort(np.abs(values)[np.abs(values) > tiny])
    for size, next_size in pairwise(sizes.tolist()):
        if size >= np.median(sizes) and next_size > _FAR * size:
            return float(f"{1.05 * size:.1e}")
    return math.inf


def _set_axis(
    axes: Axes,
    name: str,
    unit: str,
    values: NDArray[np.float64],
    limits: tuple[float, float],
    end: float,
) -> None:
    """Set limits and label of an axis that is linear in the middle and logarithmic outside."""
    low, high = limits
    label = {"x": "Real part", "y": "Imaginary part"}[name]
    if math.isfinite(end):
        low = 2 * float(values.min()) if values.min() < -end else low
        high = 2 * float(values.max()) if values.max() > end else high
        far = max(-low, high)
        share = _LINEAR_SHARE * math.log10(far / end)
        getattr(axes, f"set_{name}scale")("symlog", linthresh=end, linscale=share)
        ticks = [x for x in _ticks(end, far) if low <= x <= high]
        texts = [format_tick(tick, abs(tick) or 1.0) for tick in ticks]
        getattr(axes, f"set_{name}ticks")(ticks, texts)
        getattr(axes, f"set_{name}ticks")([], minor=True)
        label += f", logarithmic beyond ±{format_tick(end, end)}"
    getattr(axes, f"set_{name}lim")(low, high)
    getattr(axes, f"set_{name}label")(f"{label} [{unit}]")
    if name == "y":
        axes.axhline(0.0, color=MUTED, linewidth=0.8, zorder=1)


def _ticks(end: float, far: float) -> list[float]:
    """Return ticks of the linear and of the logarithmic part."""
    from nrs_design.plotting import MaxNLocator

    linear = [float(x) for x in MaxNLocator(6).tick_values(-end, end) if abs(x) <= end]
    first, last = math.ceil(math.log10(2 * end)), math.floor(math.log10(far))
    powers = range(first, last + 1, 1 + (last - first) // _DECADES)
    return sorted([*linear, *(sign * 10.0**power for sign in (-1, 1) for power in powers)])
