"""Records for identification, read and checked."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from nrs_design.axis import COMMAND_UNITS
from nrs_design.identification.datasets.checks import (
    check_saturation,
    check_time,
    check_turns,
    check_varies,
    find_stretches,
    long_stretches,
    pauses_text,
)
from nrs_design.identification.numeric import Array, Complex, usual_step
from nrs_design.identification.tables.table import Data, MeasurementTable, Source, read_table
from nrs_design.models.contact.motion import Motion

LINEAR = ("time", "deflection", "force")
ROTATIONAL = ("time", "angle", "torque")
ANGLE = ("time", "command", "angle")
VELOCITY = ("time", "command", "velocity")
FREE = (("input", "output"),)
FOLLOWED = tuple(
    ("command", output) for output in ("angle", "velocity", "torque", "force", "deflection")
)
RESPONSE = ("frequency", "magnitude", "phase")
# In dB.
_LOUDEST = 600.0


@dataclass(frozen=True, slots=True, eq=False)
class TissueRecord:
    """Reaction of a tissue to a motion."""

    source: Source  # The file
    motion: Motion  # Time in s and deflection in m (rad)
    force: Array  # Shape (n,). In N (N m).
    rotational: bool  # Whether the motion is a rotation about the pivot

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
    part: int = 0  # Number of the stretch between pauses of the file, from 0
    pauses: str | None = None  # Pauses of the file in words, with the first part
    names: tuple[str, str] = ("command", "output")  # Names of both columns in the file

    @property
    def name(self) -> str:
        """File name without its ending, and the part beyond the first."""
        part = f", part {self.part + 1}" if self.part else ""
        return self.source.path.stem + part

    @cached_property
    def step(self) -> float:
        """Usual time between samples in s."""
        return usual_step(self.time)

    @cached_property
    def stretches(self) -> tuple[slice, ...]:
        """The rows between pauses of the record."""
        return find_stretches(self.time)

    @cached_property
    def longest(self) -> slice:
        """The rows of the longest stretch."""
        return max(self.stretches, key=lambda rows: rows.stop - rows.start)


@dataclass(frozen=True, slots=True, eq=False)
class FrequencyResponse:
    """Velocity over command, at some frequencies."""

    source: Source  # The file
    frequency: Array  # Shape (m,). In rad/s.
    response: Complex  # Shape (m,). In rad/s for each unit of the command.
    unit: str = "rpm"  # Unit of the command of the thesis; no column states it


def read_tissue(data: Data, mapping: Mapping[str, str] | None = None) -> TissueRecord:
    """Read a record of ``time_s, deflection_m, force_N`` or ``time_s, angle_rad, torque_Nm``.

    A mapping leads from a name in the file to ours. A column that is missing, a gap or step back
    of time, a value that is not finite and a saturated sensor are a `DataError` with the row.
    """
    table = read_table(data, (LINEAR, ROTATIONAL), mapping or {})
    time, deflection, force = table.values.values()
    check_time(table, time)
    check_varies(table, table.layout[1], deflection)
    check_varies(table, table.layout[2], force)
    check_saturation(table, table.layout[2], force, deflection)
    return TissueRecord(
        table.source, Motion(time - time[0], deflection), force, table.layout == ROTATIONAL
    )


def read_actuator(
    data: Data, mapping: Mapping[str, str] | None = None
) -> tuple[SignalRecord | FrequencyResponse, ...]:
    """Read a record of the actuator, in parts between its pauses, or a frequency response.

    Columns are ``time_s, command_rpm`` and ``angle_rad`` or ``velocity_rad_s``, or
    ``frequency_hz, magnitude_db, phase_deg``.
    """
    table = read_table(data, (ANGLE, VELOCITY, RESPONSE), mapping or {})
    if table.layout == RESPONSE:
        return (_response(table),)
    return tuple(_actuator(table))


def read_signals(data: Data, mapping: Mapping[str, str] | None = None) -> SignalRecord:
    """Read two columns: a command, and what follows it.

    They are ``time_s, command_rpm`` and ``angle_rad`` or another measured one; any two others are
    mapped to ``input_any`` and ``output_any``.
    """
    mapping = mapping or {}
    chosen = {"input_any", "output_any"} & set(mapping.values())
    layouts = [("time", *pair) for pair in (FREE if chosen else FOLLOWED)]
    table = read_table(data, layouts, mapping)
    time, command, output = table.values.values()
    check_time(table, time)
    names = table.columns[table.layout[1]].name, table.columns[table.layout[2]].name
    if table.layout[2] == "angle":
        check_turns(table, output)
    for name, values in zip(names, (command, output), strict=True):
        check_varies(table, name, values)
    return SignalRecord(table.source, time - time[0], command, output, names=names)


def _actuator(table: MeasurementTable) -> list[SignalRecord]:
    """Return a record for every stretch between pauses in which the motor moves."""
    time, command, output = table.values.values()
    check_time(table, time)
    check_varies(table, "command", command)
    check_varies(table, table.layout[2], output)
    unit = table.columns["command"].unit
    if unit not in COMMAND_UNITS:
        units = ", ".join(f"command_{unit}" for unit in COMMAND_UNITS)
        table.fail(f"the motor takes a command in {unit}, and no velocity", 0, f"give {units}")
    is_angle = table.layout == ANGLE
    if is_angle:
        check_turns(table, output)
    parts: list[SignalRecord] = []
    for rows in long_stretches(time):
        t, u, y = time[rows], command[rows], output[rows]
        if np.ptp(u) > 0 and np.ptp(y) > 0:
            part = len(parts), None if parts else pauses_text(time - time[0])
            parts.append(SignalRecord(table.source, t - t[0], u, y, is_angle, unit, *part))
    if not parts:
        table.fail("the motor moves in no stretch between its pauses", 0, "record a motion")
    return parts


def _response(table: MeasurementTable) -> FrequencyResponse:
    frequency, magnitude, phase = table.values.values()
    if len(frequency) < 3:
        table.fail(
            f"{len(frequency)} frequencies are too few",
            max(len(frequency) - 1, 0),
            "measure at 3 or more",
        )
    bad = np.flatnonzero(frequency <= 0)
    if len(bad):
        table.fail("the frequency is not positive", int(bad[0]), "remove the row")
    bad = np.flatnonzero(np.abs(magnitude) > _LOUDEST)
    if len(bad):
        size = f"the magnitude is {magnitude[bad[0]]:.4g} dB: no motor has such a gain"
        table.fail(size, int(bad[0]), "correct the value, or remove the row")
    response = 10 ** (magnitude / 20) * np.exp(1j * phase)
    return FrequencyResponse(table.source, 2 * np.pi * frequency, response)
