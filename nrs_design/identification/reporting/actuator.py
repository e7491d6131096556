"""Output of the identification of an actuator."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from nrs_design.identification.actuator.fit import DEAD_TIME_NOTE
from nrs_design.identification.actuator.identify import ActuatorIdentification
from nrs_design.identification.reporting.view import (
    MAX_FIGURES,
    Facts,
    FindingView,
    draw_fit,
    estimate_numbers,
    label_of,
)
from nrs_design.identification.statistics import Estimate
from nrs_design.reporting.document import Bullets, Illustration, Section


def view_actuator(result: ActuatorIdentification) -> FindingView:
    """Return the output of the identification of an actuator."""
    fit, rows = result.fit, _rows(result)
    lines = [f"{name} = {value} {unit}" for name, value, unit, _ in rows]
    if fit.dead_time:
        samples = fit.dead_time.scaled(1 / result.step)
        lines.append(f"dead time = {samples} samples of {result.step:.4g} s, {DEAD_TIME_NOTE}")
    lines += [f"range: {name} {wide} {unit}" for name, _, unit, wide in rows if wide]
    lines.append(f"the range holds {result.covers}")
    return FindingView(
        result,
        kind="actuator",
        chosen="output in the time domain",
        reason="",
        ranges={name.replace(" ", "_"): (wide, unit) for name, _, unit, wide in rows if wide},
        facts=_facts(result),
        lines=lines,
        details=(),
        fits=None,
        title="Velocity model with Coulomb friction and dead time",
        claim=f"Fitted to the output in time: {lines[0]}, {lines[1]}.",
        sections=lambda: _sections(result, lines),
    )


def _rows(result: ActuatorIdentification) -> list[tuple[str, Estimate | str, str, Estimate | None]]:
    """Return name, estimate or reason for none, unit, and range for a spec."""
    fit, (gain, time_constant) = result.fit, result.fit.ranges
    return [
        ("gain", fit.gain, f"(rad/s)/{result.unit}", gain),
        ("time constant", fit.time_constant, "s", time_constant),
        ("friction", fit.friction or "not determined", result.unit, None),
        ("dead time", fit.dead_time or "not determined", "s", None),
    ]


def _facts(result: ActuatorIdentification) -> Facts:
    fit, late = result.fit, result.fit.dead_time
    gain = f"gain_rad_s_{result.unit}"
    return {
        "command_unit": result.unit,
        "sampling_step_s": result.step,
        gain: estimate_numbers(fit.gain),
        "time_constant_s": estimate_numbers(fit.time_constant),
        f"friction_{result.unit}": estimate_numbers(fit.friction) if fit.friction else None,
        "dead_time_s": estimate_numbers(late) if late else None,
        "whiteness_p": fit.uncertainty.whiteness,
        "range": {
            gain: estimate_numbers(result.fit.ranges[0]),
            "time_constant_s": estimate_numbers(result.fit.ranges[1]),
        },
        "range_covers": "confidence",
        "range_covers_words": result.covers,
    }


def _sections(result: ActuatorIdentification, lines: Sequence[str]) -> Iterator[Section]:
    text = "A proof over the range is about these motors."
    yield Section("Parameters", (Bullets("", (*lines, text)),))
    yield Section("Measured against fitted", tuple(_figures(result)))


def _figures(result: ActuatorIdentification) -> Iterator[Illustration]:
    note = label_of(result.sources)
    for number, record in enumerate(result.records[:MAX_FIGURES], 1):
        label = "Angle [rad]" if record.is_angle else "Velocity [rad/s]"
        yield Illustration(
            f"output-{number}",
            record.name,
            f"{note}Only the initial state is adapted to this record.",
            draw_fit(record.time, record.output, result.fit.motor.simulate(record), label),
        )
