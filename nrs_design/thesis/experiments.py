"""What was measured, shown and never asserted; and what follows from the printed measurements."""

from __future__ import annotations

from math import degrees
from statistics import fmean

from nrs_design.thesis.comparison import (
    ReproducedValue,
    Tolerance,
    derived,
    near,
    omitted,
    reproduced,
)
from nrs_design.thesis.errata import read_data
from nrs_design.thesis.interaction import DESIRED

# Times in s without and with switching, by experiment of 6.3.2.3, and the printed gain in %.
TIMES = ((0.75, 0.61), (0.53, 0.41), (0.09, 0.07), (0.16, 0.13))
GAINS = ("19", "21", "20", "20")
# Displayed impedances of 6.3.1.2, three of phi and three of psi, N m s/rad.
DISPLAYED = (2.1372, 2.0997, 2.1766, 2.0494, 2.0883, 2.1131)


def rows() -> tuple[ReproducedValue, ...]:
    """List the measurements, and recompute what the thesis says of them."""
    return (*_measured(), _displayed(), _commands(), *_gains())


def _measured() -> tuple[ReproducedValue, ...]:
    return tuple(
        omitted(name, section, printed, unit, because, tuple(touched))
        for name, section, printed, unit, because, *touched in read_data("measured.yaml")
    )


def _displayed() -> ReproducedValue:
    return derived(
        "displayed impedances from the desired one, phi and psi",
        "6.3.1.2",
        tuple(100 * (shown / DESIRED - 1) for shown in DISPLAYED),
        "%",
        printed=", ".join(f"{shown}" for shown in DISPLAYED),
        right=("-0.5301", "-2.2755", "1.3036", "-4.6166", "-2.8061", "-1.6519"),
        note="From the printed impedances and 2.1486 N m s/rad. In psi all three are below it, by "
        "0.065 N m s/rad on the mean, beside a printed RMSE of the whole run of 0.0444.",
    )


def _commands() -> ReproducedValue:
    return reproduced(
        "commands of 0.0873 and 0.0524 rad/s",
        "6.3.2.3",
        ("5", "3"),
        (degrees(0.0873), degrees(0.0524)),
        "deg/s",
        Tolerance(1e-3),
        note="The text has rad/s; they are round in deg/s.",
    )


def _gains() -> tuple[ReproducedValue, ReproducedValue]:
    gains = tuple(100 * (1 - fast / slow) for slow, fast in TIMES)
    return (
        near(
            "gain in withdrawal time by switching, each experiment",
            "6.3.2.3",
            GAINS,
            gains,
            "%",
            Tolerance(1e-5),
            right=("18.6667", "22.6415", "22.2222", "18.75"),
            because="the printed times are rounded to 0.01 s",
            note="Unrounded ones within that give all four. The text has phi for psi in "
            "experiments 3 and 4.",
        ),
        reproduced(
            "gain in withdrawal time by switching, mean",
            "6.3.2.3",
            "20",
            fmean(gains),
            "%",
            Tolerance(1e-5),
            right="20.5701",
        ),
    )
