"""A simulated run as a table over time: outputs, states and inputs with their names and units."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from nrs_design.models.axis import AxisType

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Signal:
    """Name and unit of a row of a response."""

    name: str  # Such as ``torque``
    unit: str  # In SI, such as ``N*m``; empty for a number

    @property
    def column(self) -> str:
        """Name of its column in a file, such as ``torque_Nm``."""
        words, unit = self.name.replace(" ", "-"), self.unit.replace("*", "").replace("/", "_")
        return f"{words}_{unit}" if unit else words

    def __str__(self) -> str:
        """Name and unit, such as ``torque [N*m]``."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name


def convert_units(signals: Iterable[Signal], axis: AxisType) -> tuple[Signal, ...]:
    """Return signals with the units of an axis, from those of a rotary axis."""
    return tuple(replace(signal, unit=axis.unit(signal.unit)) for signal in signals)


@dataclass(frozen=True, slots=True, eq=False)
class TimeResponse:
    """Response of a loop over time, with time along the last axis as in python-control."""

    t: Array  # Shape (N,). Time in s; it never falls, and is there twice where something jumps.
    y: Array  # Shape (p, N). Outputs.
    x: Array  # Shape (n, N). States.
    u: Array  # Shape (m, N). Inputs.
    # outputs, states, inputs: names and units of the rows.
    outputs: tuple[Signal, ...]
    states: tuple[Signal, ...]
    inputs: tuple[Signal, ...]
    mode: NDArray[np.int64]  # Shape (N,). Index of the controller in force from each instant on.
    modes: tuple[str, ...]  # The controllers

    def __len__(self) -> int:
        """Return the number of instants."""
        return len(self.t)

    def __getitem__(self, name: str) -> Array:
        """Return an output, an input or a state by its name, shape (N,); outputs come first."""
        return self.signals[name]

    @property
    def signals(self) -> Mapping[str, Array]:
        """All rows by name."""
        return {signal.name: row for signal, row in reversed(list(self._rows()))}

    @property
    def active(self) -> list[str]:
        """Name of the controller in force at every instant."""
        return [self.modes[k] for k in self.mode.tolist()]

    def _rows(self) -> Iterator[tuple[Signal, Array]]:
        yield from zip(self.outputs, self.y, strict=True)
        yield from zip(self.inputs, self.u, strict=True)
        yield from zip(self.states, self.x, strict=True)

    def to_csv(self) -> str:
        """Return a table: ``time_s``, outputs, inputs, states, and ``mode``, in SI.

        Numbers are written so that they are read back as the same. `nrs-design audit` and
        `identify` read these columns.
        """
        # The table holds the value after each jump.
        is_last = np.append(np.diff(self.t) > 0, True)
        rows = [("time_s", self.t), *((signal.column, row) for signal, row in self._rows())]
        modes = [self.modes[k] for k in self.mode[is_last].tolist()]
        text = io.StringIO()
        table = csv.writer(text, lineterminator="\n")
        table.writerow([*(name for name, _ in rows), "mode"])
        table.writerows(zip(*(row[is_last].tolist() for _, row in rows), modes, strict=True))
        return text.getvalue()
