"""Simulated switching: the norm under its bound, and the path in the phase plane."""

from __future__ import annotations

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
from nrs_design.switched.system import SwitchedSystem, Time

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from nrs_design.simulation.switched import Array, TimeResponse

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
    _draw_modes(below, response, used, [system.modes[i].name for i in used])
    below.set_xlabel("Time [steps]" if discrete else "Time [s]")
    legend(figure, above)
    return figure


@styled
def draw_phase_plane(response: TimeResponse, Q: Array | None, system: SwitchedSystem) -> Figure:
    """Draw a run of a system with two states, and the ellipse that it cannot leave.

    Parameters
    ----------
    response : TimeResponse
        The run; two states.
    Q : ndarray, shape (2, 2), or None
        Matrix of the Lyapunov function, None where there is none.
    system : SwitchedSystem
        Names of modes and states, and the time axis.
    """
    figure, axes = new_axes(5.0)
    # In discrete time only the points are states; the lines lead from one to the next.
    line = "o-" if system.time is Time.DISCRETE else "-"
    if Q is not None:
        x, y = _ellipse(Q, response.state[0])
        axes.plot(x, y, "--", color=VERMILLION, linewidth=1.3, label="V(x) = V(x(0))")
    for row, mode in enumerate(list(dict.fromkeys(response.mode.tolist()))[:_ROWS]):
        path = _path_in(response, mode)
        name = f"mode {short(system.modes[mode].name)}"
        axes.plot(path[:, 0], path[:, 1], line, color=color(row), markersize=3, label=name)
    axes.plot(*response.state[0], "o", color=INK, label="start")
    axes.plot(0, 0, "+", color=MUTED, markersize=11, label="rest")
    axes.set_xlabel(_with_unit(system.states[0]))
    axes.set_ylabel(_with_unit(system.states[1]))
    legend(figure, axes, 3)
    return figure


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


def _ellipse(Q: Array, x: Array) -> tuple[Array, Array]:
    angle = np.linspace(0, 2 * np.pi, 361)
    level = float(np.sqrt(x @ Q @ x))
    circle = level * np.array([np.cos(angle), np.sin(angle)])
    points = np.linalg.solve(np.linalg.cholesky(Q).T, circle)
    return points[0], points[1]
