"""What part of the complex plane a figure shows: all of it, and the many not squeezed by a few."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.reporting.style import GRID, MUTED, VERMILLION
from nrs_design.reporting.ticks import in_full

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

# A value this many times beyond the next one, and beyond most, lies far.
_FAR = 10.0
# Share of a half axis that the linear part takes, over that of the logarithmic one.
_LINEAR_SHARE = 1.5
_DECADES = 3


@dataclass(frozen=True)
class Span:
    """One axis: its limits, and the value beyond which it is logarithmic (None for nowhere)."""

    low: float
    high: float
    bend: float | None

    @property
    def note(self) -> str:
        """What the label of the axis must add."""
        if self.bend is None:
            return ""
        return f", logarithmic beyond ±{in_full(self.bend, self.bend)}"

    def ticks(self) -> list[float]:
        """Return ticks of both parts, where the axis has two."""
        from nrs_design.plotting import MaxNLocator

        assert self.bend is not None
        inner = MaxNLocator(6).tick_values(-self.bend, self.bend)
        first = math.ceil(math.log10(2 * self.bend))
        last = math.floor(math.log10(max(-self.low, self.high)))
        powers = range(first, last + 1, 1 + (last - first) // _DECADES)
        outer = [sign * 10.0**power for sign in (-1, 1) for power in powers]
        linear = [float(x) for x in inner if abs(x) <= self.bend]
        return [x for x in sorted([*outer, *linear]) if self.low <= x <= self.high]


@dataclass(frozen=True)
class View:
    """Both axes; a square one keeps a circle round."""

    real: Span
    imaginary: Span
    shade: bool
    square: bool

    def set(self, axes: Axes, unit: str) -> None:
        """Give the axes their limits, scales, labels, and the real axis."""
        spans = (("x", self.real, "Real part"), ("y", self.imaginary, "Imaginary part"))
        for name, span, label in spans:
            _scale(axes, name, span)
            getattr(axes, f"set_{name}lim")(span.low, span.high)
            getattr(axes, f"set_{name}label")(f"{label}{span.note} [{unit}]")
        axes.axhline(0.0, color=MUTED, linewidth=0.8, zorder=1)
        if self.shade:
            axes.axvspan(0.0, self.real.high, color=VERMILLION, alpha=0.17, zorder=0, linewidth=0)
        if self.square:
            axes.set_box_aspect(1)


def half_plane(points: NDArray[np.complex128], room: float = 0.12, *, shade: bool = False) -> View:
    """Show points with some room around them, as a fraction of their extent, and the origin."""
    x, y = np.append(points.real, 0.0), points.imag
    tiny = 1e-9 * float(np.abs(points).max())
    bend_x, bend_y = _bend(x, tiny), _bend(y, tiny)
    size = max(_linear(x, bend_x), _linear(y, bend_y)) or 1.0
    height = max(_linear(y, bend_y), 0.15 * size)
    left, right = (_clip(float(end), bend_x) for end in (x.min(), x.max()))
    side = max(right - left, 0.3 * size)
    real = Span(*_outer(x, left - room * side, right + 0.12 * side, bend_x), bend_x)
    top = (1.2 + room) * height
    return View(real, Span(*_outer(y, -top, top, bend_y), bend_y), shade=shade, square=False)


def disk(points: NDArray[np.complex128]) -> View:
    """Show points and the unit circle."""
    parts = np.concatenate([points.real, points.imag, np.ones(len(points) * 2 + 1)])
    bend = _bend(parts, 0.0)
    far = float(np.abs(parts).max())
    end = 1.12 * far if bend is None else 2 * far
    span = Span(-end, end, None if bend is None else max(bend, 1.2))
    return View(span, span, shade=False, square=True)


def _bend(values: NDArray[np.float64], tiny: float) -> float | None:
    """Return up to where the axis is linear: None where no value lies far beyond the others."""
    sizes = np.sort(np.abs(values)[np.abs(values) > tiny])
    for here, beyond in pairwise(sizes.tolist()):
        if here >= np.median(sizes) and beyond > _FAR * here:
            return float(f"{1.05 * here:.1e}")
    return None


def _linear(values: NDArray[np.float64], bend: float | None) -> float:
    return float(np.abs(values).max()) if bend is None else bend


def _clip(value: float, bend: float | None) -> float:
    return value if bend is None else min(max(value, -bend), bend)


def _outer(
    values: NDArray[np.float64], low: float, high: float, bend: float | None
) -> tuple[float, float]:
    """Widen limits of the linear part to the values beyond it."""
    if bend is None:
        return low, high
    if values.min() < -bend:
        low = 2 * float(values.min())
    if values.max() > bend:
        high = 2 * float(values.max())
    return low, high


def _scale(axes: Axes, name: str, span: Span) -> None:
    if span.bend is None:
        return
    decades = math.log10(max(-span.low, span.high) / span.bend)
    set_scale, set_ticks = (getattr(axes, f"set_{name}{what}") for what in ("scale", "ticks"))
    set_scale("symlog", linthresh=span.bend, linscale=_LINEAR_SHARE * decades)
    ticks = span.ticks()
    set_ticks(ticks, [in_full(tick, abs(tick) or 1.0) for tick in ticks])
    set_ticks([], minor=True)
    line = axes.axvline if name == "x" else axes.axhline
    for end in (-span.bend, span.bend):
        if span.low < end < span.high:
            line(end, color=GRID, linewidth=1.6, linestyle=":", zorder=0.5)
