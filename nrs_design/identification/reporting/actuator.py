"""Output of the identification of an actuator."""

from __future__ import annotations

from collections.abc import Iterator

from nrs_design.identification.actuator.fit import DEAD_TIME_NOTE
from nrs_design.identification.actuator.identify import ActuatorIdentification
from nrs_design.identification.reporting.view import Curve, Facts, FindingView, estimate_numbers


def view_actuator(result: ActuatorIdentification) -> FindingView:
    """Return the output of the identification of an actuator."""
    fit, unit = result.fit, result.unit
    # Name, estimate, unit, and range for a spec.
    rows = (
        ("gain", fit.gain, f"(rad/s)/{unit}", fit.ranges[0]),
        ("time constant", fit.time_constant, "s", fit.ranges[1]),
        ("friction", fit.friction, unit, None),
        ("dead time", fit.dead_time, "s", None),
    )
    lines = [f"{name} = {value or 'not determined'} {unit}" for name, value, unit, _ in rows]
    if fit.dead_time:
        samples = fit.dead_time.scaled(1 / result.step)
        lines.append(f"dead time = {samples} samples of {result.step:.4g} s, {DEAD_TIME_NOTE}")
    lines += [f"range: {name} {wide} {unit}" for name, _, unit, wide in rows if wide]
    lines.append(f"the range holds {result.covers}")
    return FindingView(
        result,
        kind="actuator",
        method="output in the time domain",
        reason="",
        ranges={name.replace(" ", "_"): (wide, unit) for name, _, unit, wide in rows if wide},
        facts=_facts(result),
        lines=lines,
        title="Velocity model with Coulomb friction and dead time",
        claim=f"Fitted to the output in time: {lines[0]}, {lines[1]}.",
        curves=lambda: _curves(result),
    )


def _facts(result: ActuatorIdentification) -> Facts:
    fit, gain = result.fit, f"gain_rad_s_{result.unit}"
    return {
        "command_unit": result.unit,
        "sampling_step_s": result.step,
        gain: estimate_numbers(fit.gain),
        "time_constant_s": estimate_numbers(fit.time_constant),
        f"friction_{result.unit}": fit.friction and estimate_numbers(fit.friction),
        "dead_time_s": fit.dead_time and estimate_numbers(fit.dead_time),
        "whiteness_p": fit.uncertainty.whiteness,
        "range": {
            gain: estimate_numbers(fit.ranges[0]),
            "time_constant_s": estimate_numbers(fit.ranges[1]),
        },
        "range_covers": "confidence",
        "range_covers_words": result.covers,
    }


def _curves(result: ActuatorIdentification) -> Iterator[Curve]:
    note = "Only the initial state is adapted to this record."
    for record in result.records:
        label = "Angle [rad]" if record.is_angle else "Velocity [rad/s]"
        fitted = result.fit.motor.simulate(record)
        yield Curve(record.name, note, label, record.time, record.output, fitted)
