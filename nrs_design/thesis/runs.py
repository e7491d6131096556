"""Chapter 6.3 and 6.4, simulated: what the model says of the experiments on the robot."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from nrs_design.simulation import metrics
from nrs_design.simulation.run import Run
from nrs_design.simulation.time_response import Array
from nrs_design.thesis import interaction, thesis
from nrs_design.thesis.comparison import Found, Recomputed


def results() -> Iterator[Found]:
    """Simulate insertion and withdrawal, the limit on the force, and tissue and tool."""
    yield from _profile()
    for speed in (5, 3):
        times = [_withdrawal(run) for run in interaction.withdrawals(speed)]
        gain = 100 * metrics.gain_in_time(*times)
        yield Recomputed((*times, gain), gain > 0, (f"{interaction.away(speed):.2f}",))
    yield _limited(interaction.PROPORTIONAL)
    yield _limited(interaction.PROPORTIONAL_FROM_MEASURED)
    yield _limited(interaction.INTEGRAL, interaction.BLEEDING)
    yield _tissue_and_tool()


def _profile() -> Iterator[Recomputed]:
    """Yield peaks on the command of figure 6.7, and the displayed impedance."""
    scenario = interaction.into(8, *interaction.PROFILE)
    stiff = interaction.run_scenario({"position": interaction.POSITION}, scenario)
    run = interaction.run_scenario({"insertion": interaction.admittance("0", "2.15")}, scenario)
    peaks = tuple(float(np.abs(r.response["torque"]).max()) for r in (stiff, run))
    yield Recomputed(peaks, peaks[0] > thesis.TORQUE > peaks[1])
    constant = interaction.into(1, (0, 4), (2, 4))
    settled = interaction.run_scenario(
        {"insertion": interaction.admittance("0", "2.15")}, constant
    ).response
    shown, _ = metrics.displayed_impedance(settled["hand"], settled["torque"])
    hand, torque = run.response["hand"], run.response["torque"]
    error = metrics.impedance_rmse(run.response.t, hand, torque, interaction.DESIRED)
    yield Recomputed((float(shown[-1]), error or math.nan))


def _withdrawal(run: Run) -> float:
    (time,) = metrics.withdrawal_times(run.response.t, run.response["hand"], run.response["torque"])
    return time


def _limited(force: str, more: str = "") -> tuple[float, float]:
    """Return the peak torque in N m and the steady error in % of force control."""
    scenario = interaction.into(1, (0, 5), (2, 5), control=interaction.BY_THRESHOLD)
    run = interaction.run_scenario(
        {"position": interaction.POSITION, "force": force}, scenario, more
    )
    ((begin, _),) = run.switches
    inside = run.response.t >= begin
    t, torque = run.response.t[inside], run.response["torque"][inside]
    peak = thesis.TORQUE * (1 + metrics.overshoot(torque, thesis.TORQUE))
    # What is left of a decay after the run, or of its arithmetic, is no steady error.
    return peak, round(100 * metrics.steady_state_error(t, torque, thesis.TORQUE), 6)


def _tissue_and_tool() -> Recomputed:
    """Judge the run of 6.4."""
    run = interaction.tissue_and_tool()
    t, hand, torque = run.response.t, run.response["hand"], run.response["torque"]
    parts: tuple[Array, Array] = np.maximum(torque, 0.0), np.minimum(torque, 0.0)
    errors = tuple(
        metrics.impedance_rmse(t, hand, part, interaction.DESIRED) or math.nan for part in parts
    )
    peaks = tuple(float(np.abs(part).max()) for part in parts)
    return Recomputed((*errors, *peaks), [name for _, name in run.switches] == ["tool"])
