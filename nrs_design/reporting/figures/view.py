"""What part of the complex plane a figure shows: all of it, and the many not squeezed by a few."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.reporting.style import MUTED
from nrs_design.reporting.ticks import in_full

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

# A value this many times beyond the next one, and beyond most, lies far.
_FAR = 10.0
# Share of a half axis that the linear part takes, over that of the logarithmic one.
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
    for here, beyond in pairwise(sizes.tolist()):
        if here >= np.median(sizes) and beyond > _FAR * here:
            return float(f"{1.05 * here:.1e}")
    return math.inf


def _set_axis(
    axes: Axes,
    name: str,
    unit: str,
    values: NDArray[np.float64],
    limits: tuple[float, float],
    end: float,
) -> None:
    """Give an axis its limits and label; beyond the end of its linear part it is logarithmic."""
    low, high = limits
    label = {"x": "Real part", "y": "Imaginary part"}[name]
    if math.isfinite(end):
        low = 2 * float(values.min()) if values.min() < -end else low
        high = 2 * float(values.max()) if values.max() > end else high
        far = max(-low, high)
        share = _LINEAR_SHARE * math.log10(far / end)
        getattr(axes, f"set_{name}scale")("symlog", linthresh=end, linscale=share)
        ticks = [x for x in _ticks(end, far) if low <= x <= high]
        texts = [in_full(tick, abs(tick) or 1.0) for tick in ticks]
        getattr(axes, f"set_{name}ticks")(ticks, texts)
        getattr(axes, f"set_{name}ticks")([], minor=True)
        label += f", logarithmic beyond ±{in_full(end, end)}"
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
