"""Chapter 4: tracking errors that were measured on the robot."""

from __future__ import annotations

from math import pi

from nrs_design.robot.simulation.tracking import MOTIONS
from nrs_design.robot.simulation.tracking.measured import MEASURED
from nrs_design.thesis.comparison import ReproducedValue, derived, omitted

_BECAUSE = "it was measured on the robot; `nrs-design robot track` shows simulated errors beside it"


def rows() -> tuple[ReproducedValue, ...]:
    """List the root mean square errors of tables 4.2 to 4.10, and the period of half of them."""
    period = derived(
        "period of sin(0.0571 (t - 10))",
        "4.33c, 4.37 to 4.39",
        2 * pi / 0.0571,
        "s",
        printed="sin(0.0571 (t - 10)), elsewhere sin(2 pi 0.1 (t - 10))",
        right="110.038",
        note="If literal; the other commands have 10 s. Which one was run is not in the text.",
        errata=("4.33c",),
    )
    return (period, *_measured())


def _measured() -> tuple[ReproducedValue, ...]:
    return tuple(
        omitted(
            f"tracking RMSE of phi, psi, d; {controller}, {moved} moves",
            f"table {table}",
            printed,
            "deg, deg, mm",
            _BECAUSE,
        )
        for controller, tables, prints in MEASURED
        for moved, table, printed in zip(MOTIONS, tables, prints, strict=True)
    )
