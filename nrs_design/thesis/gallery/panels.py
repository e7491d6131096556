"""Signals of a run as panels, in the units of the print: rad/s, N m, and mm at the contact."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise

import numpy as np

from nrs_design.reporting.figures.panels import Curve, Panel
from nrs_design.simulation.metrics import displayed_impedance
from nrs_design.simulation.run import Run
from nrs_design.simulation.time_response import Array, TimeResponse
from nrs_design.thesis import thesis
from nrs_design.thesis.interaction import DESIRED

# Thesis 6.3.1.1: from the sensor at the pivot to the contact, in m; a torque in N m is so many N.
ARM = 0.24
FORCE = ("Force at 240 mm [N]", 1 / ARM)
T_MAX = "T_max, 0.3 N m"
ENGINE = (
    "Continuous time, exact between events. Not in it: sampling (motion loop at 500 Hz, admittance "
    "every 0.1 ms), noise and bias of the force sensor, joint clearance, gravity, the other axes."
)


def speed_panel(response: TimeResponse, axis: str, *, of_the_axis: bool = True) -> Panel:
    """Show the command, and the velocity that it becomes.

    Parameters
    ----------
    response : TimeResponse
        Of a run.
    axis : str
        Name of the axis.
    of_the_axis : bool
        Whether the velocity is shown, too.
    """
    command = Curve(response.t, response["hand"], f"command of {axis}", 1)
    velocity = Curve(response.t, response["velocity"], f"velocity of {axis}", 0)
    return Panel("Speed [rad/s]", (velocity, command) if of_the_axis else (command,))


def torque_panel(
    response: TimeResponse, label: str = "torque", *, both: bool = False, force: bool = True
) -> Panel:
    """Show the torque of the contact with its limit.

    Parameters
    ----------
    response : TimeResponse
        Of a run.
    label : str
        For the legend.
    both : bool
        Whether the limit is drawn for either sign.
    force : bool
        Whether a second scale is in N.
    """
    limits = (thesis.TORQUE, -thesis.TORQUE) if both else (thesis.TORQUE,)
    curve = Curve(response.t, response["torque"], label, 0)
    return Panel("Torque [N m]", (curve,), limits, T_MAX, other=FORCE if force else None)


def depth_panel(response: TimeResponse) -> Panel:
    """Show how deep the endoscope is in what it touches.

    Parameters
    ----------
    response : TimeResponse
        Of a run.
    """
    depth = Curve(response.t, 1e3 * ARM * response["depth"], "depth", 0)
    return Panel("Depth [mm]", (depth,))


def impedance_panel(response: TimeResponse, printed: Iterable[tuple[float, float]] = ()) -> Panel:
    """Show the displayed impedance in contact.

    Parameters
    ----------
    response : TimeResponse
        Of a run.
    printed : iterable of (float, float)
        Times in s and values in N m s/rad.
    """
    shown, taken = displayed_impedance(response["hand"], response["torque"])
    curves = [Curve(response.t, np.where(taken, shown, np.nan), "displayed impedance", 0)]
    pairs = np.array(list(printed))
    if len(pairs):
        curves.append(Curve(pairs[:, 0], pairs[:, 1], "printed value", printed=True))
    return Panel("Impedance\n[N m s/rad]", tuple(curves), (DESIRED,), "desired, 2.1486")


def at(response: TimeResponse, y: Array, t: float) -> float:
    """Return a signal at an instant.

    Parameters
    ----------
    response : TimeResponse
        Of a run.
    y : ndarray, shape (N,)
        The signal.
    t : float
        In s.
    """
    return float(np.interp(t, response.t, y))


def stays(run: Run) -> tuple[tuple[float, float, str], ...]:
    """Return from when to when which controller is in force.

    Parameters
    ----------
    run : Run
        Simulated.
    """
    response = run.response
    changes = [0, *(np.flatnonzero(np.diff(response.mode)) + 1).tolist(), len(response) - 1]
    return tuple(
        (float(response.t[a]), float(response.t[b]), response.modes[int(response.mode[a])])
        for a, b in pairwise(changes)
    )


def met(run: Run, number: int) -> float:
    """Return when contact was made or lost the n-th time, in s.

    Parameters
    ----------
    run : Run
        Simulated.
    number : int
        From 0.
    """
    return run.contacts[number][0]
