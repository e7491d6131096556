"""The metrics of a run, for programs and for a table."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np

from nrs_design.simulation import metrics
from nrs_design.simulation.run import Run
from nrs_design.simulation.scenario import Array, Scenario
from nrs_design.spec import InteractionDesignSpec

# Shorter stays of force control have no steady state, in s.
SETTLED = 0.2


def summarize(spec: InteractionDesignSpec, scenario: Scenario, run: Run) -> dict[str, Any]:
    """Return the metrics of a run, in SI."""
    response = run.response
    t, torque, velocity = response.t, response["torque"], response["velocity"]
    limit, desired = spec.limits.torque.si, spec.limits.torque.si / spec.limits.velocity.si
    size = np.abs(torque)
    return {
        "duration": float(t[-1]),
        "peak_torque": float(size.max()),
        "torque_limit": limit,
        "time_above_limit": metrics.time_above(t, size, limit),
        "peak_depth": float(response["depth"].max()),
        "peak_velocity": float(np.abs(velocity).max()),
        # Agility of a robot that is led by hand (thesis 5.1.3, 7.2).
        "mean_speed": metrics.mean(t, np.abs(velocity)),
        "time_in_contact": metrics.time_above(t, size, 0.0),
        "impedance_rmse": metrics.impedance_rmse(t, response["hand"], torque, desired),
        "desired_impedance": desired,
        "withdrawal_times": list(metrics.withdrawal_times(t, response["hand"], torque)),
        "effort": asdict(metrics.effort(t, torque, velocity)),
        "rms_torque_in_contact": _rms_in_contact(t, torque),
        "force_control": _force_control(spec, scenario, run),
        "switches": len(run.switches),
        "shortest_stay": run.shortest_stay,
        "chatter": run.chatter,
        "contacts": sum(made for _, _, made in run.contacts),
    }


def _rms_in_contact(t: Array, torque: Array) -> float:
    """Return the root mean square over the time in contact, in N m; 0 without any."""
    held = metrics.time_above(t, (torque != 0).astype(float), 0.5)
    return float(metrics.rms(t, torque) * np.sqrt((t[-1] - t[0]) / held)) if held else 0.0


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
