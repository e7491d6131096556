"""Records for identification, read and checked."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from nrs_design.axis import COMMAND_UNITS
from nrs_design.identification.datasets.checks import (
    check_saturation,
    check_time,
    check_turns,
    check_varies,
)
from nrs_design.identification.numeric import Array, usual_step
from nrs_design.identification.tables.table import Data, MeasurementTable, Source, read_table
from nrs_design.models.contact.motion import Motion

LINEAR = ("time", "deflection", "force")
ROTATIONAL = ("time", "angle", "torque")
# Samples that tell the velocity at the begin.
_BEGIN = 10
ANGLE = ("time", "command", "angle")
VELOCITY = ("time", "command", "velocity")


@dataclass(frozen=True, slots=True, eq=False)
class TissueRecord:
    """Reaction of a tissue to a motion."""

    source: Source  # The file
    motion: Motion  # Time in s and deflection in m (rad)
    force: Array  # Shape (n,). In N (N m).
    rotational: bool  # Whether the motion is a rotation about the pivot
    pauses: str = ""  # What pauses leave out, in words; empty for none

    @property
    def name(self) -> str:
        """File name without its ending."""
        return self.source.path.stem


@dataclass(frozen=True, eq=False)
class SignalRecord:
    """A command and a measured signal that follows it."""

    source: Source  # The file
    # time, command, output: shape (n,). In s, in the unit of the command, and of a motor in rad or
    # rad/s.
    time: Array
    command: Array
    output: Array
    is_angle: bool = True  # Output of a motor: angle, or velocity if False
    unit: str = "rpm"  # Unit of the command: ``rpm``, ``V``, ``A`` or ``counts``
    pauses: str = ""  # What pauses leave out, in words; empty for none
    names: tuple[str, str] = ("command", "output")  # Names of both columns in the file

    @property
    def name(self) -> str:
        """File name without its ending."""
        return self.source.path.stem

    @cached_property
    def step(self) -> float:
        """Usual time between samples in s."""
        return usual_step(self.time)

    @cached_property
    def first_velocity(self) -> float:
        """Velocity of a motor at the begin, about, in rad/s."""
        if not self.is_angle:
            return float(self.output[0])
        return float(np.polyfit(self.time[:_BEGIN], self.output[:_BEGIN], 2)[1])


def read_tissue(data: Data, mapping: Mapping[str, str] | None = None) -> TissueRecord:
    """Read a record of ``time_s, deflection_m, force_N`` or ``time_s, angle_rad, torque_Nm``.

    A mapping leads from a name in the file to ours. A column that is missing, a gap or step back
    of time, a value that is not finite and a saturated sensor are a `DataError` with the row.
    """
    table, pauses = _uninterrupted(read_table(data, (LINEAR, ROTATIONAL), mapping or {}))
    time, deflection, force = table.values.values()
    check_varies(table, table.layout[1], deflection)
    check_varies(table, table.layout[2], force)
    check_saturation(table, table.layout[2], force, deflection)
    return TissueRecord(
        table.source, Motion(time, deflection), force, table.layout == ROTATIONAL, pauses
    )


def read_actuator(data: Data, mapping: Mapping[str, str] | None = None) -> SignalRecord:
    """Read a record of the actuator.

    Columns are ``time_s, command_rpm`` and ``angle_rad`` or ``velocity_rad_s``.
    """
    table, pauses = _uninterrupted(read_table(data, (ANGLE, VELOCITY), mapping or {}))
    time, command, output = table.values.values()
    check_varies(table, "command", command)
    check_varies(table, table.layout[2], output)
    unit = table.columns["command"].unit
    if unit not in COMMAND_UNITS:
        units = ", ".join(f"command_{unit}" for unit in COMMAND_UNITS)
        table.fail(f"the motor takes a command in {unit}, and no velocity", 0, f"give {units}")
    is_angle = table.layout == ANGLE
    if is_angle:
        check_turns(table, output)
    return SignalRecord(table.source, time, command, output, is_angle, unit, pauses)


def read_signals(data: Data, mapping: Mapping[str, str]) -> SignalRecord:
    """Read two columns that are mapped to ``input_any`` and ``output_any``."""
    table, pauses = _uninterrupted(read_table(data, (("time", "input", "output"),), mapping))
    time, command, output = table.values.values()
    names = table.columns["input"].name, table.columns["output"].name
    for name, values in zip(names, (command, output), strict=True):
        check_varies(table, name, values)
    return SignalRecord(table.source, time, command, output, pauses=pauses, names=names)


def _uninterrupted(table: MeasurementTable) -> tuple[MeasurementTable, str]:
    """Return the longest rows without a pause, time from zero, and what is left out."""
    rows, pauses = check_time(table, table.values["time"])
    values = {name: column[rows] for name, column in table.values.items()}
    values["time"] = values["time"] - values["time"][0]
    return replace(table, values=values, first_line=table.first_line + rows.start), pauses
