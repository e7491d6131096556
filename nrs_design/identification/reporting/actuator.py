"""The page of the identification of an actuator."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.identification.reporting.figures.identification import draw_bode, draw_fit
from nrs_design.identification.reporting.identification import (
    DRAWN,
    figure_names,
    identification_page,
    in_interval,
    label_of,
    marked,
)
from nrs_design.reporting.document import Block, Bullets, Illustration, Report, Section, Table
from nrs_design.reporting.formatting import number

if TYPE_CHECKING:
    from nrs_design.identification.actuator.identify import ActuatorIdentification
    from nrs_design.identification.actuator.model import ActuatorFit


def actuator_report(found: ActuatorIdentification) -> Report:
    """Say and draw everything about the identification of an actuator."""
    fit = found.chosen
    unit = found.unit
    values = [
        f"Gain {in_interval(fit.gain)} (rad/s)/{unit}",
        f"τ {in_interval(fit.time_constant)} s",
    ]
    if fit.friction:
        values.append(f"friction {in_interval(fit.friction)} {unit}")
    if fit.dead_time:
        values.append(f"dead time {in_interval(fit.dead_time)} s")
    return identification_page(
        found,
        name="actuator",
        title=f"Velocity model of order {fit.order} with Coulomb friction and dead time",
        claim=f"{', '.join(values)}. {found.reason}",
        sections=(
            Section("Fits", (fits(found), *_ranges(found), *_derived(found))),
            *_bode(found),
            *_actuator_records(found),
        ),
    )


def _dead_time(fit: ActuatorFit) -> str:
    """Return the dead time of a fit in s; only a fit in time has one."""
    if fit.dead_time is None:
        return "taken for zero" if fit.motor is None else "not determined"
    return in_interval(fit.dead_time)


def fits(found: ActuatorIdentification) -> Table:
    """Return the estimates of every method."""
    rows = tuple(
        (
            marked(fit.method, chosen=fit is found.chosen),
            in_interval(fit.gain),
            in_interval(fit.time_constant),
            in_interval(fit.friction) if fit.friction else "not determined",
            _dead_time(fit),
        )
        for fit in found.fits
    )
    columns = (
        "Fit",
        f"Gain [(rad/s)/{found.unit}]",
        "Time constant [s]",
        f"Friction [{found.unit}]",
        "Dead time [s]",
    )
    return Table("Estimates [95 % interval]", columns, rows)


def _ranges(found: ActuatorIdentification) -> tuple[Block, ...]:
    """Say what a proof covers that takes the range from here."""
    if found.chosen.order != 1:
        return ()
    names = (f"Gain [(rad/s)/{found.unit}]", "Time constant [s]")
    row = (found.coverage, *map(in_interval, found.ranges))
    text = f"The range holds {found.covers}. A proof over that range is about these motors."
    return Table("Range for a spec", ("It holds", *names), (row,)), Bullets("", (text,))


def _derived(found: ActuatorIdentification) -> Iterator[Table]:
    if found.figures is None:
        return
    yield Table(
        f"Derived with the data sheet: {found.figures.sheet}",
        ("Quantity", "Value [95 % interval]", "Unit"),
        (
            ("Armature resistance R", in_interval(found.figures.resistance), "ohm"),
            ("Speed over torque", in_interval(found.figures.gradient), "rpm/(N m)"),
        ),
    )


def _bode(found: ActuatorIdentification) -> Iterator[Section]:
    if not len(found.frequency):
        return
    figure = Illustration(
        "bode",
        "Velocity over command",
        f"{label_of(found.sources)}Magnitude relative to 1 (rad/s)/{found.unit}. The first "
        "harmonic of the friction is taken off the command.",
        draw_bode(found),
    )
    yield Section("Frequency response", (figure,))


def _actuator_records(found: ActuatorIdentification) -> tuple[Section, ...]:
    if not found.records or found.chosen.motor is None:
        return ()
    title = "Records"
    picks = list(range(len(found.records)))[:DRAWN]
    if len(found.frequency):
        title = "Slowest and fastest record"
        order = np.argsort(found.frequency)
        picks = list(dict.fromkeys([int(order[0]), int(order[-1])]))
    names = figure_names([found.records[i].name for i in picks])
    blocks = tuple(_output_figure(found, i, name) for i, name in zip(picks, names, strict=True))
    return (Section(title, blocks),)


def _output_figure(found: ActuatorIdentification, index: int, name: str) -> Illustration:
    record, motor = found.records[index], found.chosen.motor
    fitted = record.output if motor is None else motor.simulate(record)
    hertz = (
        f": {number(found.frequency[index] / (2 * math.pi), 3)} Hz" if len(found.frequency) else ""
    )
    label = "Angle [rad]" if record.is_angle else "Velocity [rad/s]"
    return Illustration(
        f"{'angle' if record.is_angle else 'velocity'}-{name}",
        f"{record.name}{hertz}",
        f"{label_of(found.sources)}The chosen fit; only the initial state is adapted to this "
        "record.",
        draw_fit(record.time, record.output, fitted, label),
    )
