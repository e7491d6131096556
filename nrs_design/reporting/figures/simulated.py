"""A simulated scenario: torque, deflection and velocity over time, with limits and controllers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import groupby
from typing import TYPE_CHECKING, Any

import numpy as np

from nrs_design.models.axis import current, labelled, unit
from nrs_design.proof.bounds import upper
from nrs_design.reporting.style import (
    BLUE,
    GREEN,
    INK,
    MUTED,
    ORANGE,
    PURPLE,
    SKY,
    VERMILLION,
    new_figure,
    styled,
)

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from nrs_design.simulation.time_response import TimeResponse

# A bound above this multiple of the largest torque is named at the edge, not drawn to scale.
_FAR = 4.0
_FIRST: dict[str, Any] = {"color": BLUE, "lw": 1.6}
_SECOND: dict[str, Any] = {"color": INK, "lw": 1.2, "linestyle": (0, (6, 2, 1.5, 2))}
_LIMIT: dict[str, Any] = {"color": GREEN, "linestyle": ":", "lw": 1.5}
_BOUND: dict[str, Any] = {"color": VERMILLION, "linestyle": "--", "lw": 1.4}
# Pale, so that a page's light or dark shows through.
_SHADES, _PALE = (SKY, ORANGE, GREEN, PURPLE, BLUE, VERMILLION), 0.16
# Width of a panel in letters; a stay that is narrower than its name goes without.
_LETTERS = 56


@dataclass(frozen=True, slots=True, eq=False)
class Panel:
    """Axes with signals over one time."""

    label: str  # Quantity and unit
    curves: dict[str, NDArray[np.float64]]  # By name, shape (N,), in the unit
    limits: tuple[float, ...] = ()  # Horizontal lines
    bounds: tuple[float, ...] = ()  # Horizontal lines that nothing crosses
    bound: str = ""  # Legend of the bounds


def draw_simulated(
    response: TimeResponse,
    torque_limit: float,
    velocity_limit: float,
    lever_arm: float | None,
    bound: tuple[float, bool] | None = None,
) -> Figure:
    """Draw a run; limits in N m and rad/s.

    With a lever arm in m the deflection is in mm, else in deg. A bound on the torque in N m comes
    with whether it is about this run.
    """
    torque, deg = response["torque"], current().fine
    scale, length = (deg, unit("deg")) if lever_arm is None else (1e3 * lever_arm, "mm")
    signs = (1, -1) if bool((torque < -0.01 * torque_limit).any()) else (1,)
    title, bound_label = "", "certified bound"
    bounds: tuple[float, ...] = ()
    if bound is not None:
        level, covers_run = bound
        bound_label = bound_label if covers_run else "bound, not about this run"
        if level > _FAR * max(torque_limit, float(np.abs(torque).max())):
            title = f"{bound_label} {upper(Fraction(level), 4)} {unit('N m')}, beyond this scale"
        else:
            bounds = tuple(sign * level for sign in signs)
    fastest = deg * velocity_limit
    speeds = {"of the axis": deg * response["velocity"], "commanded": deg * response["hand"]}
    limits = tuple(sign * torque_limit for sign in signs)
    panels = (
        Panel(labelled("Torque [N m]"), {"torque": torque}, limits, bounds, bound_label),
        Panel(f"Deflection [{length}]", {"deflection": scale * response["depth"]}),
        Panel(labelled("Velocity [deg/s]"), speeds, (fastest, -fastest)),
    )
    return draw_panels(response.t, panels, [*iterate_stays(response.t, response.active)], title)


def iterate_stays(
    t: NDArray[np.float64], active: Sequence[str]
) -> Iterator[tuple[float, float, str]]:
    """Yield begin and end of every stay, and the name that is active from one time to the next."""
    begin = 0
    for name, steps in groupby(active):
        end = begin + len(list(steps))
        yield float(t[begin]), float(t[min(end, len(t) - 1)]), name
        begin = end


@styled
def draw_panels(
    t: NDArray[np.float64],
    panels: Sequence[Panel],
    intervals: Sequence[tuple[float, float, str]] = (),
    title: str = "",
) -> Figure:
    """Draw panels above each other, and shade who is in control when."""
    figure = new_figure(1.1 + 1.45 * len(panels))
    column = figure.subplots(len(panels), sharex="col", squeeze=False)[:, 0]
    names = list(dict.fromkeys(name for _, _, name in intervals))
    handles: dict[str, Artist] = {}
    span = float(t[0]), float(t[-1])
    for axes, panel in zip(column, panels, strict=True):
        _draw_panel(axes, t, panel, handles)
        _shade(axes, span, intervals, names, has_names=axes is column[0])
        axes.set_ylabel(panel.label)
    column[-1].set(xlabel="Time [s]", xlim=span)
    if title:
        column[0].set_title(title, fontsize=9.5, pad=18 if intervals else 6)
    figure.align_ylabels(column)
    _legend(figure, handles, names)
    return figure


def _draw_panel(
    axes: Axes, t: NDArray[np.float64], panel: Panel, handles: dict[str, Artist]
) -> None:
    for look, (name, y) in zip((_FIRST, _SECOND), panel.curves.items(), strict=False):
        (line,) = axes.plot(t, y, label=name, **look)
        # The label of the axis names a single curve.
        if len(panel.curves) > 1:
            handles.setdefault(name, line)
    lines = [(level, "limit of the spec", _LIMIT) for level in panel.limits]
    lines += [(level, panel.bound, _BOUND) for level in panel.bounds]
    for level, label, look in lines:
        handles.setdefault(label, axes.axhline(level, label=label, **look))


def _shade(
    axes: Axes,
    span: tuple[float, float],
    intervals: Sequence[tuple[float, float, str]],
    names: Sequence[str],
    *,
    has_names: bool,
) -> None:
    for low, high, name in intervals:
        if low >= high:
            continue
        tint = _SHADES[names.index(name) % len(_SHADES)]
        axes.axvspan(low, high, color=tint, alpha=_PALE, linewidth=0, zorder=0)
        if has_names and _LETTERS * (high - low) > (len(name) + 1) * (span[1] - span[0]):
            transform = axes.get_xaxis_transform()
            place: dict[str, Any] = {"transform": transform, "ha": "center", "va": "bottom"}
            axes.text((low + high) / 2, 1.02, name, color=MUTED, fontsize=8.5, **place)


def _legend(figure: Figure, handles: dict[str, Artist], names: Sequence[str]) -> None:
    from nrs_design.plotting import Patch

    shades = {
        f"controller: {name}": Patch(facecolor=_SHADES[i % len(_SHADES)], alpha=_PALE)
        for i, name in enumerate(names)
    }
    items: dict[str, Artist] = handles | shades
    if not items:
        return
    columns = max(1, min(3, 70 // (max(map(len, items)) + 6)))
    figure.set_figheight(figure.get_figheight() + 0.2 * -(-len(items) // columns))
    figure.legend([*items.values()], [*items], loc="outside lower center", ncols=columns)
