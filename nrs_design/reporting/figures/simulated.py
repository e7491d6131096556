"""A simulated scenario: torque, deflection and velocity over time, with limits and modes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.proof.bounds import upper
from nrs_design.reporting.style import (
    BLUE,
    GREEN,
    INK,
    MUTED,
    ORANGE,
    PURPLE,
    VERMILLION,
    new_figure,
    styled,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from nrs_design.simulation.time_response import TimeResponse

_POINTS = 4000
# Behind the curves, one for each controller: pale, and told apart without colour by their names.
_SHADES = (BLUE, VERMILLION, GREEN, PURPLE, MUTED, ORANGE)
_PALE = 0.12
# A bound beyond so many times the largest torque is named at the edge, not drawn to scale.
_FAR = 4.0


@styled
def draw_simulated(
    response: TimeResponse,
    torque_limit: float,
    velocity_limit: float,
    lever_arm: float | None,
    bound: tuple[float, bool] | None = None,
) -> Figure:
    """Draw a run.

    Parameters
    ----------
    response : TimeResponse
        With angle, velocity, torque and depth, and the commanded velocity ``hand``.
    torque_limit, velocity_limit : float
        In N m and rad/s.
    lever_arm : float or None
        From the pivot to the contact in m; with it, the deflection is in mm, else in deg.
    bound : tuple of (float, bool), optional
        Certified bound on the torque in N m, and whether it is about this run.
    """
    figure = new_figure(6.4)
    rows: Sequence[Axes] = figure.subplots(3, 1, sharex=True)
    pick = np.unique(np.linspace(0, len(response) - 1, _POINTS).astype(int))
    t = response.t[pick]
    _draw_torque(rows[0], t, response["torque"][pick], torque_limit, bound)
    depth = response["depth"][pick]
    if lever_arm is None:
        rows[1].plot(t, np.degrees(depth), color=BLUE)
        rows[1].set_ylabel("Deflection [deg]")
    else:
        rows[1].plot(t, 1e3 * lever_arm * depth, color=BLUE)
        rows[1].set_ylabel("Deflection [mm]")
    hand, velocity = response["hand"][pick], response["velocity"][pick]
    rows[2].plot(t, np.degrees(velocity), color=BLUE, label="of the axis")
    rows[2].plot(t, np.degrees(hand), color=INK, linestyle=(0, (4, 2)), lw=1.2, label="commanded")
    for sign in (1, -1):
        rows[2].axhline(sign * np.degrees(velocity_limit), color=GREEN, linestyle=":", lw=1.4)
    rows[2].set_ylabel("Velocity [deg/s]")
    rows[2].set_xlabel("Time [s]")
    rows[2].set_xlim(float(response.t[0]), float(response.t[-1]))
    for axes in rows:
        _shade(axes, response)
    about = None if bound is None else bound[1]
    _legend(figure, rows, response, about)
    return figure


def _draw_torque(
    axes: Axes,
    t: np.ndarray[tuple[int, ...], np.dtype[np.float64]],
    torque: np.ndarray[tuple[int, ...], np.dtype[np.float64]],
    limit: float,
    bound: tuple[float, bool] | None,
) -> None:
    axes.plot(t, torque, color=BLUE)
    two_sided = bool((torque < -0.01 * limit).any())
    for sign in (1, -1) if two_sided else (1,):
        axes.axhline(sign * limit, color=GREEN, linestyle=":", lw=1.4)
        if bound is not None and bound[0] <= _FAR * max(limit, float(np.abs(torque).max())):
            axes.axhline(sign * bound[0], color=VERMILLION, linestyle="--", lw=1.4)
    if bound is not None and bound[0] > _FAR * max(limit, float(np.abs(torque).max())):
        axes.set_title(f"bound {upper(Fraction(bound[0]), 4)} N m, beyond this scale", fontsize=9)
    axes.set_ylabel("Torque [N m]")


def _stays(response: TimeResponse) -> Iterator[tuple[float, float, int]]:
    """Yield begin and end of every stay, and the controller."""
    changes = np.flatnonzero(np.diff(response.mode)) + 1
    starts = [0, *changes.tolist()]
    ends = [*changes.tolist(), len(response) - 1]
    for start, end in zip(starts, ends, strict=True):
        yield float(response.t[start]), float(response.t[end]), int(response.mode[start])


def _shade(axes: Axes, response: TimeResponse) -> None:
    for begin, end, mode in _stays(response):
        shade = _SHADES[mode % len(_SHADES)]
        axes.axvspan(begin, end, color=shade, alpha=_PALE, linewidth=0, zorder=0)


def _legend(
    figure: Figure, rows: Sequence[Axes], response: TimeResponse, about: bool | None
) -> None:
    from nrs_design.plotting import Line2D, Patch, to_rgba

    handles: list[Line2D | Patch] = [
        Line2D([], [], color=BLUE, label="simulated"),
        Line2D([], [], color=INK, linestyle=(0, (4, 2)), lw=1.2, label="commanded"),
        Line2D([], [], color=GREEN, linestyle=":", lw=1.4, label="limit of the spec"),
    ]
    if any(line.get_color() == VERMILLION for line in rows[0].get_lines()):
        label = "certified bound" if about else "bound, not about this run"
        dashed = Line2D([], [], color=VERMILLION, linestyle="--", lw=1.4, label=label)
        handles.append(dashed)
    for mode in np.unique(response.mode).tolist():
        shade = to_rgba(_SHADES[mode % len(_SHADES)], _PALE)
        handles.append(Patch(facecolor=shade, edgecolor=MUTED, label=response.modes[mode]))
    figure.legend(handles=handles, loc="outside lower center", ncols=3)
