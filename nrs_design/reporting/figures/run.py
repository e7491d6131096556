"""Simulated switching: the norm under its bound, and the path in the phase plane."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.reporting.style import (
    BLUE,
    INK,
    MUTED,
    VERMILLION,
    color,
    legend,
    new_axes,
    new_figure,
    short,
    styled,
)
from nrs_design.simulation.norms import Norm, level_curve
from nrs_design.switched.system import SwitchedSystem, Time

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from nrs_design.simulation.norms import Array
    from nrs_design.simulation.switched import TimeResponse

_ROWS = 10


@styled
def draw_run(
    response: TimeResponse,
    norm: Array,
    bound: tuple[str, Array] | None,
    system: SwitchedSystem,
    label: str,
) -> Figure:
    """Draw a norm over time, its proved bound, and below them the mode that is active.

    Parameters
    ----------
    response : TimeResponse
        The run.
    norm : ndarray, shape (N + 1,)
        Norm of its states over the first one.
    bound : tuple of str and ndarray, shape (N + 1,), or None
        A curve to hold it against, with its label.
    system : SwitchedSystem
        Names of the modes, and the time axis.
    label : str
        Which norm it is.
    """
    used = list(dict.fromkeys(response.mode.tolist()))[:_ROWS]
    figure = new_figure(4.2 + 0.22 * len(used))
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=[4.0, 0.2 + 0.3 * len(used)])
    discrete = system.time is Time.DISCRETE
    shape = {"marker": "o", "markersize": 2.5} if discrete and len(norm) <= 80 else {}
    above.semilogy(
        response.time, np.maximum(norm, np.finfo(float).tiny), color=BLUE, label="run", **shape
    )
    if bound is not None:
        above.semilogy(response.time, bound[1], "--", color=VERMILLION, label=bound[0])
    above.set_ylabel(label)
    _write_plainly(above)
    if discrete:
        below.locator_params(axis="x", integer=True)
    _draw_modes(below, response, used, [system.modes[i].name for i in used])
    below.set_xlabel("Time [steps]" if discrete else "Time [s]")
    legend(figure, above)
    return figure


@styled
def draw_mode_levels(
    response: TimeResponse, system: SwitchedSystem, norms: Mapping[str, Norm]
) -> Figure:
    """Draw a run in the plane with a level curve of every mode's own function.

    Parameters
    ----------
    response : TimeResponse
        The run; two states.
    system : SwitchedSystem
        Names of modes and states, and the time axis.
    norms : mapping
        Root of the function of each mode by its name; all at the value of the first active one at
        the start.
    """
    figure, axes = new_axes(5.2)
    line = "o-" if system.time is Time.DISCRETE else "-"
    used = list(dict.fromkeys(response.mode.tolist()))[:_ROWS]
    start = float(norms[system.modes[used[0]].name](response.state[0]))
    names = [system.modes[mode].name for mode in used]
    for row, (mode, name) in enumerate(zip(used, names, strict=True)):
        path = _path_in(response, mode)
        axes.plot(*path.T, line, color=color(row), markersize=3, label=f"mode {short(name)}")
    for row, name in enumerate(names):
        x, y = level_curve(norms[name], start)
        axes.plot(x, y, "--", color=color(row), linewidth=1.2, label=f"level of V, {short(name)}")
    _finish_plane(figure, axes, response, system, 3)
    return figure


@styled
def draw_phase_plane(
    response: TimeResponse,
    system: SwitchedSystem,
    norm: Norm | None = None,
    levels: Sequence[float] = (1.0,),
) -> Figure:
    """Draw a run of a system with two states, and the level curves that it cannot leave.

    Parameters
    ----------
    response : TimeResponse
        The run; two states.
    system : SwitchedSystem
        Names of modes and states, and the time axis.
    norm : callable, optional
        Root of the Lyapunov function, where there is one.
    levels : sequence of float
        Level curves to draw, relative to the start; the first is named.
    """
    figure, axes = new_axes(5.0)
    # In discrete time only the points are states; the lines lead from one to the next.
    line = "o-" if system.time is Time.DISCRETE else "-"
    if norm is not None:
        _draw_levels(axes, norm, float(norm(response.state[0])), levels)
    for row, mode in enumerate(list(dict.fromkeys(response.mode.tolist()))[:_ROWS]):
        path = _path_in(response, mode)
        name = f"mode {short(system.modes[mode].name)}"
        axes.plot(path[:, 0], path[:, 1], line, color=color(row), markersize=3, label=name)
    _finish_plane(figure, axes, response, system, 3)
    return figure


def _finish_plane(
    figure: Figure, axes: Axes, response: TimeResponse, system: SwitchedSystem, columns: int
) -> None:
    axes.plot(*response.state[0], "o", color=INK, label="start")
    axes.plot(0, 0, "+", color=MUTED, markersize=11, label="rest")
    axes.set_xlabel(_with_unit(system.states[0]))
    axes.set_ylabel(_with_unit(system.states[1]))
    legend(figure, axes, columns)


def _write_plainly(axes: Axes) -> None:
    """Write 0.6 rather than 6 times a power of ten where the axis spans few decades."""
    low, high = axes.get_ylim()
    if high > 200 * low:
        return
    digits = (1, 3) if high > 30 * low else (1, 2, 3, 4, 6)

    def text(value: float, position: float) -> str:
        digit = value / 10.0 ** math.floor(math.log10(value) + 1e-9)
        # On a short axis, the ticks are chosen as on a linear one, and all are written.
        wanted = high < 3 * low or min(abs(digit - d) for d in digits) < 0.01
        return f"{value:.4g}" if wanted else ""

    axes.yaxis.set_major_formatter(text)
    axes.yaxis.set_minor_formatter(text)


def _with_unit(state: str) -> str:
    """Label a state; given matrices and the canonical form come without units."""
    return f"State {state}" if "[" in state else f"State {state} [no unit given]"


def _draw_modes(axes: Axes, response: TimeResponse, used: list[int], names: list[str]) -> None:
    """Draw one bar for each time that a mode is active, one row per mode."""
    edges = np.flatnonzero(np.diff(response.mode)) + 1
    starts = np.concatenate([[0], edges])
    ends = np.concatenate([edges, [len(response.mode)]])
    for row, mode in enumerate(used):
        spans = [
            (response.time[a], response.time[b] - response.time[a])
            for a, b in zip(starts, ends, strict=True)
            if response.mode[a] == mode
        ]
        axes.broken_barh(spans, (row - 0.35, 0.7), color=color(row), linewidth=0)
    axes.set_yticks(range(len(used)), [short(name) for name in names])
    axes.set_ylim(len(used) - 0.4, -0.6)
    axes.set_title("Active mode", loc="left", fontsize=9.5)
    axes.grid(visible=False, axis="y")


def _path_in(response: TimeResponse, mode: int) -> Array:
    """Return the states with every step of another mode cut out by NaN."""
    ends = response.state[1:].copy()
    begins = response.state[:-1].copy()
    other = response.mode != mode
    ends[other], begins[other] = np.nan, np.nan
    gaps = np.full_like(begins, np.nan)
    gaps[:-1][response.mode[1:] == mode] = begins[1:][response.mode[1:] == mode]
    return np.stack([begins, ends, gaps], axis=1).reshape(-1, 2)


def _draw_levels(axes: Axes, norm: Norm, start: float, levels: Sequence[float]) -> None:
    for index, level in enumerate(levels):
        x, y = level_curve(norm, level * start)
        outer = index == 0
        axes.plot(
            x,
            y,
            "--" if outer else ":",
            color=VERMILLION,
            linewidth=1.3 if outer else 1.0,
            label="V(x) = V(x(0))" if outer else None,
            zorder=1.5,
        )
