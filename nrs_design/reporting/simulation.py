"""Table rows of the metrics of a run, in display units."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from decimal import ROUND_CEILING, Context
from typing import Any

from nrs_design.models.axis import current, unit

# Smaller numbers are shown as zero.
_NOTHING = 1e-9


def four_digits_up(value: float) -> str:
    """Return a number with four digits, rounded up."""
    return f"{float(Context(prec=4, rounding=ROUND_CEILING).create_decimal(repr(value))):.4g}"


def metric_rows(m: Mapping[str, Any], limits: Mapping[str, float]) -> Iterator[list[str]]:
    """Yield rows of name, value, unit and limit, of metrics and limits in SI.

    Limits are those of the scenario; the spec's of the torque is in the metrics.
    """
    limit = f"{limits.get('torque', m['torque_limit']):.4g}"
    # Metrics with a limit are rounded up: a violation is never displayed as within the limit.
    yield ["largest torque", four_digits_up(m["peak_torque"]), unit("N m"), limit]
    duration_label = f"time above {m['torque_limit']:.4g} {unit('N m')}"
    yield [duration_label, four_digits_up(m["time_above_limit"]), "s", "0"]
    yield _peak("largest deflection", m["peak_depth"], "deg", limits.get("deflection"))
    yield _row("time in contact", m["time_in_contact"], "s")
    if m["impedance_rmse"] is not None:
        target_text = f"off the wanted {m['desired_impedance']:.4g}"
        name = "RMSE of the displayed impedance"
        yield _row(name, m["impedance_rmse"], unit("N m s/rad"), target_text)
    yield _row("duration", m["duration"], "s")
    for time in m["withdrawal_times"]:
        yield _row("withdrawal from tissue", time, "s")
    yield _row("mean speed", current().fine * m["mean_speed"], unit("deg/s"))
    yield _peak("largest speed", m["peak_velocity"], "deg/s", limits.get("velocity"))
    yield _row("applied torque, total", m["effort"]["total"], unit("N m s"))
    yield _row("applied torque, rms", m["effort"]["rms"], unit("N m"))
    yield _row("energy", m["effort"]["energy"], "J")
    for stay in m["force_control"]:
        yield _row(f"overshoot under {stay['controller']}", 100 * stay["overshoot"], "%")
        error = 100 * stay["steady_state_error"]
        yield _row(f"steady-state error under {stay['controller']}", error, "%")
    yield _row("switches", m["switches"], "")
    if m["chatter"]:
        yield _row("stays below 10 ms (chatter)", m["chatter"], "", "0")
    if m["shortest_stay"] is not None:
        yield _row("shortest stay", m["shortest_stay"], "s")


def _peak(name: str, value: float, turning: str, limit: float | None) -> list[str]:
    """Return a position or a speed, never below a limit where it is not."""
    fine, unit_text = current().fine, unit(turning)
    if limit is None:
        return _row(name, fine * value, unit_text)
    return [name, four_digits_up(fine * value), unit_text, f"{fine * limit:.4g}"]


def _row(name: str, value: float, unit_text: str, limit: str = "") -> list[str]:
    nonzero_value = 0.0 if abs(value) < _NOTHING else value
    return [name, f"{nonzero_value:.4g}", unit_text, limit]
