"""The metrics of a run, for programs and for a table."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np

from nrs_design.simulation import metrics
from nrs_design.simulation.run import Run
from nrs_design.simulation.scenario import Scenario
from nrs_design.spec import InteractionDesignSpec

# Shorter stays of force control have no steady state, in s.
SETTLED = 0.2


def summarize(spec: InteractionDesignSpec, scenario: Scenario, run: Run) -> dict[str, Any]:
    """Return the metrics of a run, in SI."""
    response = run.response
    t, torque, velocity = response.t, response["torque"], response["velocity"]
    limit, desired = spec.limits.torque.si, spec.limits.torque.si / spec.limits.velocity.si
    size = np.abs(torque)
    out = metrics.withdrawal_times(t, response["hand"], torque)
    touched = size > 0
    return {
        "duration": float(t[-1]),
        "peak_torque": metrics.peak(torque),
        "torque_limit": limit,
        "time_above_limit": metrics.time_above(t, size, limit),
        "peak_depth": float(response["depth"].max()),
        "peak_velocity": metrics.peak(velocity),
        "mean_speed": metrics.mean_speed(t, velocity),
        "time_in_contact": metrics.time_above(t, size, 0.0),
        "impedance_rmse": metrics.impedance_rmse(t, response["hand"], torque, desired),
        "desired_impedance": desired,
        "withdrawal_times": list(out),
        "effort": asdict(metrics.effort(t, torque, velocity)),
        "rms_torque_in_contact": rms_where(response.t, torque, touched),
        "force_control": _force_control(spec, scenario, run),
        "switches": len(run.switches),
        "shortest_stay": run.shortest_stay,
        "chatter": run.chatter,
        "contacts": sum(made for _, _, made in run.contacts),
    }


def rms_where(t: np.ndarray[Any, Any], y: np.ndarray[Any, Any], where: Any) -> float:
    """Return the root mean square over the time in which something holds; 0 if it never does."""
    held = metrics.time_above(t, where.astype(float), 0.5)
    length = float(t[-1] - t[0])
    if not held:
        return 0.0
    return float(metrics.rms(t, np.where(where, y, 0.0)) * np.sqrt(length / held))


def _force_control(
    spec: InteractionDesignSpec, scenario: Scenario, run: Run
) -> list[dict[str, float | str]]:
    """Return overshoot and steady-state error of every long stay in force control."""
    response, wanted = run.response, scenario.wanted_torque
    found: list[dict[str, float | str]] = []
    stays = [(0.0, scenario.control.start), *run.switches]
    ends = [*(time for time, _ in run.switches), float(response.t[-1])]
    for (begin, name), end in zip(stays, ends, strict=True):
        if not spec.controllers[name].holds_force or end - begin < SETTLED:
            continue
        inside = (response.t >= begin) & (response.t < end)
        t, torque = response.t[inside], response["torque"][inside]
        if wanted and len(t) > 1:
            found.append(
                {
                    "controller": name,
                    "from": begin,
                    "to": end,
                    "overshoot": metrics.overshoot(torque, wanted),
                    "steady_state_error": metrics.steady_state_error(t, torque, wanted),
                }
            )
    return found
