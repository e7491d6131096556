"""A simulated scenario: torque, deflection and velocity over time, with limits and controllers."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.axis import current, labelled, unit
from nrs_design.proof.bounds import upper
from nrs_design.reporting.figures.panels import Curve, Panel, PanelColumn, draw_panels

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from nrs_design.simulation.time_response import TimeResponse

# A bound beyond so many times the largest torque is named at the edge, not drawn to scale.
_FAR = 4.0


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
    t, torque = response.t, response["torque"]
    signs = (1, -1) if bool((torque < -0.01 * torque_limit).any()) else (1,)
    title, about = "", "certified bound"
    bounds: tuple[float, ...] = ()
    if bound is not None:
        level, covers = bound
        about = about if covers else "bound, not about this run"
        if level > _FAR * max(torque_limit, float(np.abs(torque).max())):
            title = f"{about} {upper(Fraction(level), 4)} {unit('N m')}, beyond this scale"
        else:
            bounds = tuple(sign * level for sign in signs)
    deg = current().fine
    scale, length = (deg, unit("deg")) if lever_arm is None else (1e3 * lever_arm, "mm")
    fastest = deg * velocity_limit
    panels = (
        Panel(
            labelled("Torque [N m]"),
            (Curve(t, torque, "torque"),),
            tuple(sign * torque_limit for sign in signs),
            "limit of the spec",
            bounds=bounds,
            bound=about,
        ),
        Panel(f"Deflection [{length}]", (Curve(t, scale * response["depth"], "deflection"),)),
        Panel(
            labelled("Velocity [deg/s]"),
            (
                Curve(t, deg * response["velocity"], "of the axis"),
                Curve(t, deg * response["hand"], "commanded", look=3),
            ),
            (fastest, -fastest),
            "limit of the spec",
        ),
    )
    span = (float(t[0]), float(t[-1]))
    return draw_panels([PanelColumn(title, panels, span, tuple(_stays(response)))])


def _stays(response: TimeResponse) -> Iterator[tuple[float, float, str]]:
    """Yield begin and end of every stay, and the controller."""
    changes = (np.flatnonzero(np.diff(response.mode)) + 1).tolist()
    for start, end in zip([0, *changes], [*changes, len(response) - 1], strict=True):
        name = response.modes[int(response.mode[start])]
        yield float(response.t[start]), float(response.t[end]), name
