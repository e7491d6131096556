"""Simulated switching: the norm under its bound, and the path in the phase plane."""

from __future__ import annotations

from collections.abc import Sequence
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
from nrs_design.switched.system import Time

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from nrs_design.simulation.switched import Array, TimeResponse

_ROWS = 10
# Below this fraction of the start, a simulated norm is rounding noise.
_NOISE = 1e-12


@styled
def draw_run(
    response: TimeResponse,
    norm: Array,
    bound: Array | None,
    names: Sequence[str],
    time: Time,
    label: str,
) -> Figure:
    """Draw a norm over time, its proved bound, and below them the mode that is active.

    Parameters
    ----------
    response : TimeResponse
        The run.
    norm : ndarray, shape (N + 1,)
        Norm of its states over the first one.
    bound : ndarray, shape (N + 1,), or None
        What the certificate allows at most.
    names : sequence of str
        Of all modes.
    time : Time
        Continuous or discrete.
    label : str
        Which norm it is.
    """
    used = list(dict.fromkeys(response.mode.tolist()))[:_ROWS]
    figure = new_figure(4.2 + 0.22 * len(used))
    above, below = figure.subplots(
        2, 1, sharex=True, height_ratios=[4.0, 0.2 + 0.3 * len(used)]
    )
    discrete = time is Time.DISCRETE
    shape = {"marker": "o", "markersize": 2.5} if discrete and len(norm) <= 80 else {}
    above.semilogy(response.time, np.maximum(norm, _NOISE), color=BLUE, label="run", **shape)
    if bound is not None:
        name = "proved bound, " + ("rho^t" if discrete else "exp(-alpha t)")
        above.semilogy(response.time, bound, "--", color=VERMILLION, label=name)
    above.set_ylabel(label)
    _draw_modes(below, response, used, [names[i] for i in used])
    below.set_xlabel("Time [steps]" if discrete else "Time [s]")
    legend(figure, above)
    return figure


@styled
def draw_phase_plane(
    response: TimeResponse, Q: Array | None, names: Sequence[str], states: Sequence[str]
) -> Figure:
    """Draw a run of a system with two states, and the ellipse that it cannot leave.

    Parameters
    ----------
    response : TimeResponse
        The run; two states.
    Q : ndarray, shape (2, 2), or None
        Matrix of the Lyapunov function, None where there is none.
    names, states : sequence of str
        Of the modes and of the states.
    """
    figure, axes = new_axes(5.0)
    if Q is not None:
        x, y = _ellipse(Q, response.state[0])
        axes.plot(x, y, "--", color=VERMILLION, linewidth=1.3, label="V(x) = V(x(0))")
    for row, mode in enumerate(list(dict.fromkeys(response.mode.tolist()))[:_ROWS]):
        path = _path_in(response, mode)
        axes.plot(path[:, 0], path[:, 1], color=color(row), label=f"mode {short(names[mode])}")
    axes.plot(*response.state[0], "o", color=INK, label="start")
    axes.plot(0, 0, "+", color=MUTED, markersize=11, label="rest")
    axes.set_xlabel(f"{states[0]}")
    axes.set_ylabel(f"{states[1]}")
    axes.set_aspect("equal", adjustable="datalim")
    legend(figure, axes, 3)
    return figure


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
    axes.set_ylabel("Active mode")
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
