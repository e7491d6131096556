"""What makes a record unusable: time that does not advance, gaps, saturation."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from nrs_design.identification.numeric import Array, Flags, parted, runs
from nrs_design.identification.statistics import span
from nrs_design.identification.tables.table import MeasurementTable
from nrs_design.proof.text import counted
from nrs_design.spec.plausible import doubt_size
from nrs_design.spec.quantity import SMALLEST

FEWEST_ROWS = 50
# Length of a gap, in usual steps.
GAP = 3.0
# A sensor is saturated when its extreme reading repeats while this part of the motion passes.
_FLAT_ROWS = 10
_FLAT_MOTION = 0.05
# Changes up to this number of units in the last place are rounding.
_ROUNDING_UNITS = 8


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
    if len(time) < FEWEST_ROWS:
        table.fail(
            f"the record has {len(time)} rows, at least {FEWEST_ROWS} are needed",
            max(len(time) - 1, 0),
            "record longer",
        )
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
    used = span(time[rows.start] - time[0], time[rows.stop - 1] - time[0], "s")
    return rows, (
        f"{counted(pauses, 'pause')} in the record: its longest stretch is used ({used}), and "
        f"{left} left out; a stretch that is saved as a file is a record, too"
    )


def longest_stretch(time: Array) -> slice:
    """Return the longest rows without a gap."""
    return slice(*max(parted(find_gaps(time)), key=lambda ends: ends[1] - ends[0]))


def check_advance(table: MeasurementTable, time: Array) -> None:
    """Check that time advances."""
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
    if len(time) and float(np.ptp(time)) <= SMALLEST:
        table.fail("time hardly advances", len(time) - 1, "write it in s, ms, us or ns")


def check_turns(table: MeasurementTable, angle: Array) -> None:
    """Check that an angle does not jump by a whole turn, as a reading modulo 360 deg does."""
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
    span = float(np.ptp(moving))
    for extreme in {float(values.max()), float(values.min())} - {0.0}:
        for first, last in runs(values == extreme):
            if last - first >= _FLAT_ROWS and np.ptp(moving[first:last]) > _FLAT_MOTION * span:
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
        by = f" by more than {change:.1g}, which is rounding" if change else ""
        table.fail(f"the {name} never changes{by}", 0, "record a motion, from before it begins")
