"""The log of a running loop, with whatever columns it has."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from nrs_design.identification.datasets.records import check_advance, find_gaps
from nrs_design.identification.errors import DataError
from nrs_design.identification.numeric import Array, Flags, Rows, usual_step
from nrs_design.identification.tables.table import Data, Source, read_table

_OPTIONAL = ("angle", "torque", "deflection", "force", "velocity", "command", "mode")


@dataclass(frozen=True, slots=True, eq=False)
class RunLog:
    """A log."""

    source: Source  # The file
    time: Array  # Shape (n,). In s, from zero.
    # By quantity, shape (n,) each, in SI; the mode as an index into the labels.
    columns: dict[str, Array]
    labels: tuple[str, ...]  # Names of modes in the order in which they come
    begin: float  # Time of the first row in the file, in s
    command_unit: str  # Unit of the command; empty without a command

    @property
    def step(self) -> float:
        """Usual time between rows in s."""
        return usual_step(self.time)

    @property
    def gaps(self) -> Flags:
        """Between which rows others are missing, shape (n - 1,)."""
        return find_gaps(self.time)

    @property
    def modes(self) -> Rows | None:
        """Index of the label in force at every row, or None."""
        return self.columns["mode"].astype(np.int64) if "mode" in self.columns else None

    def time_of(self, row: float) -> float:
        """Return the time of a row in the file, in s."""
        return self.begin + float(self.time[int(row)])

    def convert_to_radians(self) -> RunLog:
        """Return the log with a command that is a velocity in rad/s, as a robot takes it."""
        if self.command_unit != "rpm":
            return self
        columns = {**self.columns, "command": self.columns["command"] * (np.pi / 30)}
        return replace(self, columns=columns, command_unit="rad/s")


def read_run(data: Data, mapping: Mapping[str, str] | None = None) -> RunLog:
    """Read ``time_s`` and the other columns that the file has.

    They are ``angle_rad, torque_Nm`` or ``deflection_m, force_N``, ``velocity_rad_s``,
    ``command_UNIT`` and ``mode``, the name of the controller in force.
    """
    table = read_table(data, (("time",),), mapping or {}, _OPTIONAL)
    columns = dict(table.values)
    time = columns.pop("time")
    if not columns:
        raise DataError(
            "has no column beside the time that could be judged",
            path=table.source.path,
            remedy="name columns such as angle_rad, torque_Nm, command_rpm, mode; see --map",
        )
    check_advance(table, time)
    unit = table.columns["command"].unit if "command" in columns else ""
    return RunLog(table.source, time - time[0], columns, table.labels, float(time[0]), unit)
