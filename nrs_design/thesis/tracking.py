"""Chapter 4: tracking errors that were measured on the robot."""

from __future__ import annotations

from collections.abc import Iterator
from math import pi

from nrs_design.robot.simulation.tracking.experiment import MOTIONS
from nrs_design.robot.simulation.tracking.measured import MEASURED
from nrs_design.thesis.comparison import PrintedRow, Recomputed, ReproducedValue, judge

_BECAUSE = "it was measured on the robot; `nrs-design robot track` shows simulated errors beside it"


def results() -> tuple[float]:
    """Recompute the period of half of the measurements."""
    return (2 * pi / 0.0571,)


def measured() -> Iterator[ReproducedValue]:
    """List the root mean square errors of tables 4.2 to 4.10."""
    for controller, tables, prints in MEASURED:
        for moved, table, printed in zip(MOTIONS, tables, prints, strict=True):
            name = f"tracking RMSE of phi, psi, d; {controller}, {moved} moves"
            row = PrintedRow(
                "not reproducible",
                name,
                f"table {table}",
                printed,
                "deg, deg, mm",
                because=_BECAUSE,
            )
            yield judge(row, Recomputed())
