"""Records for identification, read and checked."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Generic, TypeVar

import numpy as np

from nrs_design.identification.numeric import Array, Flags, parted, runs, usual_step
from nrs_design.identification.statistics import span
from nrs_design.identification.tables.table import Data, MeasurementTable, Source, read_table
from nrs_design.models.axis import COMMAND_UNITS
from nrs_design.models.contact.motion import Motion
from nrs_design.proof.text import counted
from nrs_design.spec.plausible import doubt_size
from nrs_design.spec.quantity import SMALLEST

LINEAR = ("time", "deflection", "force")
ROTATIONAL = ("time", "angle", "torque")
ANGLE = ("time", "command", "angle")
VELOCITY = ("time", "command", "velocity")
# Samples that tell the velocity at the begin.
_BEGIN = 10
FEWEST_ROWS = 50
# Length of a gap, in usual steps.
GAP = 3.0
# A sensor is saturated when its extreme reading repeats while this part of the motion passes.
_FLAT_ROWS = 10
_FLAT_MOTION = 0.05
# Changes up to this number of units in the last place are rounding.
_ROUNDING_UNITS = 8


@dataclass(frozen=True, eq=False)
class AbstractRecord:
    """Measured signals of one file."""

    source: Source  # The file
    pauses: str = field(default="", kw_only=True)  # Rows left out for pauses, as a sentence

    @property
    def name(self) -> str:
        """File name without its ending."""
        return self.source.path.stem


@dataclass(frozen=True, eq=False)
class TissueRecord(AbstractRecord):
    """Reaction of a tissue to a motion."""

    motion: Motion  # Time in s and deflection in m (rad)
    force: Array  # Shape (n,). In N (N m).
    rotational: bool  # Whether the motion is a rotation about the pivot


@dataclass(frozen=True, eq=False)
class SignalRecord(AbstractRecord):
    """A command and a measured signal that follows it."""

    # time, command, output: shape (n,). In s, in the unit of the command, and of a motor in rad or
    # rad/s.
    time: Array
    command: Array
    output: Array
    is_angle: bool = True  # Output of a motor: angle, or velocity if False
    unit: str = "rpm"  # Unit of the command: ``rpm``, ``V``, ``A`` or ``counts``
    names: tuple[str, str] = ("command", "output")  # Names of both columns in the file

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


R = TypeVar("R", bound=AbstractRecord)


@dataclass(frozen=True, eq=False)
class AbstractIdentification(ABC, Generic[R]):
    """Estimates from records."""

    records: tuple[R, ...]  # The data

    @property
    @abstractmethod
    def doubts(self) -> tuple[str, ...]:
        """Evidence against the estimates: it makes them inconclusive."""

    @property
    @abstractmethod
    def caveats(self) -> tuple[str, ...]:
        """Doubts, and the effects that a proof with these estimates leaves out."""

    @property
    def sources(self) -> tuple[Source, ...]:
        """The files."""
        return tuple(record.source for record in self.records)

    @property
    def remarks(self) -> tuple[str, ...]:
        """Pauses in the records, as sentences."""
        return tuple(f"{r.name}: {r.pauses}" for r in self.records if r.pauses)


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
    motion, rotational = Motion(time, deflection), table.layout == ROTATIONAL
    return TissueRecord(table.source, motion, force, rotational, pauses=pauses)


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
    return SignalRecord(table.source, time, command, output, is_angle, unit, pauses=pauses)


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


def question_sizes(sizes: Iterable[tuple[str, str, float, str]]) -> Iterator[str]:
    """Doubt implausible values; each has a key of the table, a name, a value and its unit."""
    for key, name, value, unit in sizes:
        if question := doubt_size(key, value, unit, f"{value:.3g}"):
            yield f"{name} is {value:.3g} {unit}: {question}"


def doubt_step(step: float) -> Iterator[str]:
    """Doubt a usual step in s that no logger has: seconds were read as milliseconds, or back."""
    if question := doubt_size("recorded_step", step, "s", f"{step:.3g}"):
        question = question.replace("its unit", "their unit")
        yield f"the steps of time are {step:.3g} s: {question} (--map names another)"


def find_gaps(time: Array) -> Flags:
    """Tell between which of n rows others are missing, shape (n - 1,)."""
    steps = np.diff(time)
    return np.asarray(steps > GAP * np.median(steps))


def check_time(table: MeasurementTable, time: Array) -> tuple[slice, str]:
    """Check that time advances; return the longest rows without a pause, and what is left out."""
    check_advance(table, time)
    rows = longest_stretch(time)
    if rows.stop - rows.start < FEWEST_ROWS:
        steps = np.diff(time)
        row = int(np.argmax(find_gaps(time))) + 1
        table.fail(
            f"a gap of {steps[row - 1]:.4g} s, where steps are {np.median(steps):.4g} s, and no "
            f"{FEWEST_ROWS} rows without one",
            row,
            "record without interruption",
        )
    if not (pauses := int(find_gaps(time).sum())):
        return rows, ""
    left = counted(len(time) - (rows.stop - rows.start), "row")
    times = span(time[rows.start] - time[0], time[rows.stop - 1] - time[0], "s")
    return rows, (
        f"{counted(pauses, 'pause')} in the record: its longest stretch is used ({times}), and "
        f"{left} left out; to use other stretches, save each as a file"
    )


def longest_stretch(time: Array) -> slice:
    """Return the longest rows without a gap."""
    return slice(*max(parted(find_gaps(time)), key=lambda ends: ends[1] - ends[0]))


def check_advance(table: MeasurementTable, time: Array) -> None:
    """Check that there are enough rows, and that time advances."""
    if len(time) < FEWEST_ROWS:
        message = f"the record has {len(time)} rows, at least {FEWEST_ROWS} are needed"
        table.fail(message, max(len(time) - 1, 0), "record longer")
    steps = np.diff(time)
    stuck = np.flatnonzero(steps <= 0)
    if len(stuck):
        row = int(stuck[0]) + 1
        word = "repeats" if steps[row - 1] == 0 else "goes back"
        table.fail(
            f"time {word}: {time[row]:.9g} s after {time[row - 1]:.9g} s",
            row,
            "sort the rows, or remove the doubled ones",
        )
    if float(np.ptp(time)) <= SMALLEST:
        table.fail("time hardly advances", len(time) - 1, "write it in s, ms, us or ns")


def check_turns(table: MeasurementTable, angle: Array) -> None:
    """Check that an angle has no jumps of 2 pi, as readings modulo 360 deg have."""
    steps = np.abs(np.diff(angle))
    jumps = np.flatnonzero(np.abs(steps - 2 * np.pi) < np.pi / 4)
    if len(jumps) and float(np.median(steps)) < np.pi / 4:
        table.fail(
            "the angle jumps by a whole turn: it begins anew after each",
            int(jumps[0]) + 1,
            "count the turns, so that the angle goes on (np.unwrap)",
        )


def check_saturation(table: MeasurementTable, name: str, values: Array, moving: Array) -> None:
    """Check that a sensor does not rest at its extreme reading during a motion."""
    way = float(np.ptp(moving))
    for extreme in {float(values.max()), float(values.min())} - {0.0}:
        for first, last in runs(values == extreme):
            if last - first >= _FLAT_ROWS and np.ptp(moving[first:last]) > _FLAT_MOTION * way:
                table.fail(
                    f"the {name} stays at its extreme reading {extreme:.6g} for "
                    f"{last - first} rows: the sensor is saturated",
                    first,
                    "record with a larger measuring range",
                )


def check_varies(table: MeasurementTable, name: str, values: Array) -> None:
    """Check that a column is not constant, but for the rounding of its numbers."""
    change = float(np.ptp(values))
    if change <= max(SMALLEST, _ROUNDING_UNITS * np.finfo(float).eps * float(np.abs(values).max())):
        amount = f" by more than {change:.1g}, which is rounding" if change else ""
        table.fail(f"the {name} never changes{amount}", 0, "record a motion, from before it begins")
