"""``nrs-design identify actuator``: the motor from records of commands, or a response."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Annotated

import typer

from nrs_design.cli.command import Answer, command
from nrs_design.cli.destinations import Destinations
from nrs_design.cli.options import Date, ReportTo
from nrs_design.cli.printing import detail, progress, say
from nrs_design.identification.cli.identify.common import (
    ColumnMap,
    CoversOption,
    DataFiles,
    Replace,
    WriteTo,
    deliver,
    print_fits,
    read_all,
)
from nrs_design.identification.facts.actuator import actuator_facts

if TYPE_CHECKING:
    from nrs_design.identification.actuator.identify import ActuatorIdentification


@command("identify-actuator")
def actuator(
    data: DataFiles,
    columns: ColumnMap = None,
    torque_constant: Annotated[float | None, typer.Option(min=1e-9, help="K_T in N m/A.")] = None,
    back_emf_constant: Annotated[
        float | None, typer.Option(min=1e-9, help="K_B in V s/rad.")
    ] = None,
    inertia: Annotated[
        float | None, typer.Option(min=1e-15, help="At the motor shaft, in kg m^2.")
    ] = None,
    reduction: Annotated[float | None, typer.Option(min=1e-9, help="Gearhead ratio N.")] = None,
    covers: Annotated[
        CoversOption,
        typer.Option(help="What the range holds: this motor, 95 % of records, or the next one."),
    ] = CoversOption.CONFIDENCE,
    write: WriteTo = None,
    narrower: Replace = False,
    report: ReportTo = None,
    date: Date = None,
) -> Answer:
    """Fit gain, time constant, Coulomb friction and dead time of a motor that follows a velocity.

    Columns: time_s, command_rpm (or _V, _A, _counts), and angle_rad or velocity_rad_s; any command
    that moves the motor: sinusoids, steps, stairs, chirps, random ones, in open or closed loop.
    One file is one record; groups of columns have suffixes _1, _2, ... Or a frequency response:
    frequency_hz, magnitude_db, phase_deg. The data sheet is that of thesis table 4.1 unless given.

    Example: nrs-design identify actuator specs/data/actuator-*hz.csv --report reports/actuator.html
    """
    from nrs_design.identification.actuator import THESIS_MOTOR
    from nrs_design.identification.actuator.identify import identify_actuator
    from nrs_design.identification.datasets.records import read_actuator
    from nrs_design.identification.reporting.actuator import actuator_report
    from nrs_design.identification.write_spec import check_actuator, merge_actuator

    outputs = Destinations.checked(write, report, date)
    given = {
        "torque_constant": torque_constant,
        "back_emf_constant": back_emf_constant,
        "inertia": inertia,
        "reduction": reduction,
    }
    motor = replace(THESIS_MOTOR, **{key: v for key, v in given.items() if v is not None})
    files = read_all(data, read_actuator, columns or [])
    records = [record for file in files for record in file]
    if outputs.spec is not None:
        for record in records:
            check_actuator(outputs.spec, record.unit)
    with progress("fitting") as step:
        found = identify_actuator(records, motor, covers.value, step)
    merge = partial(merge_actuator, replace=narrower)
    return deliver(outputs, found, actuator_facts, _print, actuator_report, merge)


def _print(found: ActuatorIdentification) -> None:
    from nrs_design.identification.reporting.actuator import fits

    print_fits(fits(found))
    say(f"chosen: {found.chosen.method}. {found.reason}")
    if found.chosen.dead_time and found.step:
        from nrs_design.identification.actuator.model import FROM_THE_ROW

        samples = found.chosen.dead_time.scaled(1 / found.step)
        say(f"dead time = {samples} samples of {found.step:.4g} s, {FROM_THE_ROW}")
    motor = found.chosen.motor
    if motor is not None and motor.damping is not None:
        say(f"second order: damping ratio {motor.damping:.4g}; time constants add up")
    if found.chosen.order == 1:
        gain, time_constant = found.ranges
        say(f"range: gain {gain} (rad/s)/{found.unit}, time constant {time_constant} s")
        say(f"the range holds {found.covers}")
    if found.figures is not None:
        detail(f"R = {found.figures.resistance} ohm")
        detail(f"speed over torque = {found.figures.gradient} rpm/(N m)")
        detail(f"both for a motor with {found.figures.sheet}; options give another data sheet")
