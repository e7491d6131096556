"""Metrics of a run: safety, agility, human effort, and performance of controllers.

Throughout, ``t`` are the instants of a run in s, shape (N,), which need not be equally far apart,
and ``y`` is a signal at them, a straight line between two: velocities in rad/s, torques in N m.
Numbers of the thesis stand beside the equations.
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nrs_design.simulation.run import Run
from nrs_design.simulation.scenario import Array, Scenario
from nrs_design.spec import InteractionDesignSpec

# Smallest command in a displayed impedance, as a fraction of the largest one.
SMALLEST_SHARE = 0.1
# Last part of a run, which counts as settled.
LAST_SHARE = 0.1
# Shorter stays of force control have no steady state, in s.
SETTLED = 0.2

Mask = NDArray[np.bool_]


def integral(t: Array, y: Array) -> float:
    """Return ``int y dt`` over a run."""
    return float(np.trapezoid(y, t))


def mean(t: Array, y: Array) -> float:
    """Return the mean over time, ``1/T int y dt``; the only value, where a run has no length."""
    length = float(t[-1] - t[0])
    return integral(t, y) / length if length > 0 else float(y[0])


def rms(t: Array, y: Array) -> float:
    """Return ``sqrt(1/T int y^2 dt)``; the square of a straight line is integrated exactly."""
    length = float(t[-1] - t[0])
    if length <= 0:
        return abs(float(y[0]))
    squares = (y[1:] ** 2 + y[1:] * y[:-1] + y[:-1] ** 2) / 3
    return math.sqrt(float(np.sum(np.diff(t) * squares)) / length)


def time_above(t: Array, y: Array, limit: float) -> float:
    """Return for how long a signal is above a limit, in s; crossings are interpolated."""
    low, high = np.minimum(y[1:], y[:-1]), np.maximum(y[1:], y[:-1])
    crosses = (low <= limit) & (high > limit)
    share = np.where(low > limit, 1.0, 0.0)
    share[crosses] = (high[crosses] - limit) / (high[crosses] - low[crosses])
    return float(np.sum(np.diff(t) * share))


def displayed_impedance(command: Array, torque: Array) -> tuple[Array, Mask]:
    """Return ``|F| / |v_c|`` where there is contact and a command to divide by (thesis 6.3.1).

    From v_c in rad/s and F in N m, shape (N,): in N m s/rad, zero where it is not taken; and where
    it is taken.
    """
    size = np.abs(command)
    mask = (torque != 0) & (size > SMALLEST_SHARE * size.max(initial=0.0))
    return np.divide(np.abs(torque), size, out=np.zeros_like(size), where=mask), mask


def impedance_rmse(t: Array, command: Array, torque: Array, desired: float) -> float | None:
    """Return the root mean square of displayed less desired impedance (thesis 6.3, 6.4).

    ``sqrt(1/T int (|F|/|v_c| - Z_des)^2 dt)`` in N m s/rad, over the time in contact; the thesis
    measures 0.1234 to 0.5333 on the robot. None without contact under a command.
    """
    quotient, mask = displayed_impedance(command, torque)
    intervals = mask[1:] & mask[:-1]
    widths = np.diff(t)[intervals]
    if not widths.sum() > 0:
        return None
    squares = (quotient - desired) ** 2
    means = (squares[1:] + squares[:-1])[intervals] / 2
    return math.sqrt(float(np.sum(widths * means) / widths.sum()))


def withdrawal_times(t: Array, command: Array, torque: Array) -> tuple[float, ...]:
    """Return how long each move out of tissue took, in s (thesis 6.3.2, figures 6.18 to 6.21).

    From the moment when the command begins to point out of tissue that pushes, to the loss of
    contact; a move that is turned round, or not over at the end, does not count. The torque of the
    contact has the sign of a command into the tissue.
    """
    durations: list[float] = []
    begin: float | None = None
    for time, v, F in zip(t.tolist(), command.tolist(), torque.tolist(), strict=True):
        if F == 0.0:
            if begin is not None:
                durations.append(time - begin)
            begin = None
        elif v * F < 0 and begin is None:
            begin = time
        elif v * F > 0:
            begin = None
    return tuple(durations)


@dataclass(frozen=True, slots=True)
class Effort:
    """Human effort, or effort of the robot against its environment."""

    total: float  # ``int |F| dt`` in N m s: the total applied torque of thesis 5.1.4
    rms: float  # ``sqrt(1/T int F^2 dt)`` in N m
    energy: float  # ``int |F v| dt`` in J


def effort(t: Array, torque: Array, velocity: Array) -> Effort:
    """Return the effort of a run: `Effort` has the equations."""
    energy = integral(t, np.abs(torque * velocity))
    return Effort(integral(t, np.abs(torque)), rms(t, torque), energy)


def overshoot(y: Array, target: float) -> float:
    """Return ``max(y/target) - 1``, at least 0, for a response to a target of either sign."""
    return max(0.0, float((y / target).max()) - 1)


def steady_state_error(t: Array, y: Array, target: float) -> float:
    """Return by which share of a target the mean of the last tenth of a run misses it.

    ``|1 - mean(y)/target|``; the thesis finds 2 to 12 % for proportional force control.
    """
    last = t >= t[-1] - LAST_SHARE * (t[-1] - t[0])
    return abs(1 - mean(t[last], y[last]) / target)


def summarize(spec: InteractionDesignSpec, scenario: Scenario, run: Run) -> dict[str, Any]:
    """Return the metrics of a run, in SI."""
    response = run.response
    t, torque, velocity = response.t, response["torque"], response["velocity"]
    limit, desired = spec.limits.torque.si, spec.limits.torque.si / spec.limits.velocity.si
    size, contact_time = np.abs(torque), time_above(t, (torque != 0).astype(float), 0.5)
    contact_factor = np.sqrt((t[-1] - t[0]) / contact_time) if contact_time else 0.0
    return {
        "duration": float(t[-1]),
        "peak_torque": float(size.max()),
        "torque_limit": limit,
        "time_above_limit": time_above(t, size, limit),
        "peak_depth": float(response["depth"].max()),
        "peak_velocity": float(np.abs(velocity).max()),
        # Agility of a robot that is led by hand (thesis 5.1.3, 7.2).
        "mean_speed": mean(t, np.abs(velocity)),
        "time_in_contact": time_above(t, size, 0.0),
        "impedance_rmse": impedance_rmse(t, response["hand"], torque, desired),
        "desired_impedance": desired,
        "withdrawal_times": list(withdrawal_times(t, response["hand"], torque)),
        "effort": asdict(effort(t, torque, velocity)),
        "rms_torque_in_contact": float(rms(t, torque) * contact_factor),
        "force_control": _force_control(spec, scenario, run),
        "switches": len(run.switches),
        "shortest_stay": run.shortest_stay,
        "chatter": run.chatter,
        "contacts": sum(is_met for _, _, is_met in run.contacts),
    }


def _force_control(
    spec: InteractionDesignSpec, scenario: Scenario, run: Run
) -> list[dict[str, float | str]]:
    """Return overshoot and steady-state error of every long stay in force control."""
    response, target = run.response, scenario.wanted_torque
    end = float(response.t[-1])
    summaries: list[dict[str, float | str]] = []
    for (start, name), (stop, _) in pairwise(
        [(0.0, scenario.control.start), *run.switches, (end, "")]
    ):
        if not spec.controllers[name].holds_force or stop - start < SETTLED:
            continue
        mask = (response.t >= start) & (response.t < stop)
        t, torque = response.t[mask], response["torque"][mask]
        if target and len(t) > 1:
            errors = {
                "overshoot": overshoot(torque, target),
                "steady_state_error": steady_state_error(t, torque, target),
            }
            summaries.append({"controller": name, "from": start, "to": stop, **errors})
    return summaries
