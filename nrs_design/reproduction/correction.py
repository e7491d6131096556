"""Chapters 3.4 and 3.5: correction coefficients of the simplified model."""

from __future__ import annotations

import numpy as np

from nrs_design.models.robot import Correction, correction_coefficients
from nrs_design.models.robot.correction import DEPTH_SINES, TABLE_3_5, WHOLE_WORKSPACE, Sine
from nrs_design.reproduction.comparison import (
    ReproducedValue,
    Tolerance,
    meets_standard,
    misprint,
    near,
    omitted,
    reproduced,
)
from nrs_design.reproduction.neuroboscope import robot

# Thesis table 3.5: the rows with plain sines, in its order.
SINES = (
    ("1.8318", "1.8263", "2.2651"),
    ("1.8318", "1.8259", "2.2701"),
    ("1.8314", "1.8243", "2.2664"),
    ("1.8315", "1.8239", "2.2711"),
    ("1.8310", "1.8257", "2.2111"),
    ("1.8325", "1.8268", "2.2120"),
    ("1.8299", "1.8228", "2.2114"),
    ("1.8314", "1.8239", "2.2121"),
    ("1.8212", "1.8157", "2.1845"),
    ("1.8226", "1.8167", "2.1819"),
    ("1.8197", "1.8115", "2.1840"),
    ("1.8208", "1.8125", "2.1813"),
)
# Its rows that follow figure 3.7, by depth, and its last row.
FIGURE = (
    ("150 - 160", "1.8280, 1.8286, 2.2689"),
    ("195 - 205", "1.8269, 1.8292, 2.2121"),
    ("240 - 250", "1.8147, 1.8207, 2.1834"),
)
WHOLE = ("1.8311", "1.8472", "2.2111")
FINAL = ("1.8246", "1.8226", "2.2051")
# theta4 in deg, section, K1 and K2, K3.
TILTS = (
    (-10.0, "table 3.7", ("1.83", "1.83"), "2.18"),
    (-28.5, "4.19", ("1.848", "1.845"), "2.152"),
    (-40.0, "table 3.7", ("1.85", "1.85"), "2.12"),
    (-70.0, "table 3.7", ("1.88", "1.88"), "1.9"),
)
_FIGURE = "The trajectory of figure 3.7 is not in the text."
_AXIAL = (
    "The axial place of the platform's center of mass is not printed, nor are the samples; with "
    "10 mm beyond d the coefficients come this near."
)


def rows() -> tuple[ReproducedValue, ...]:
    """Recompute tables 3.5 and 3.7 along slow sines in phase."""
    sines = (_sine(sine, print_) for sine, print_ in zip(TABLE_3_5, SINES, strict=True))
    figure = (
        omitted(f"K_corr along figure 3.7, d {d} mm", "table 3.5", print_, "", _FIGURE)
        for d, print_ in FIGURE
    )
    tilts = (row for tilt in TILTS for row in _tilt(*tilt))
    return (*sines, *figure, _whole(), _final(), *tilts)


def _sine(sine: Sine, printed: tuple[str, str, str]) -> ReproducedValue:
    low, high = (1e3 * d for d in sine.d)
    return near(
        f"K_corr, phi {sine.phi:g}, psi {sine.psi:g} rad, d {low:.0f} - {high:.0f} mm",
        "table 3.5",
        printed,
        _ratios(correction_coefficients(robot(), sine)),
        "",
        Tolerance(1e-2),
        note=_AXIAL,
    )


def _whole() -> ReproducedValue:
    found = correction_coefficients(robot(), WHOLE_WORKSPACE)
    return omitted(
        "K_corr over the whole workspace",
        "table 3.5",
        ", ".join(WHOLE),
        "",
        "Mean of ratios of which some are of two values near zero, so it hangs on the samples and "
        f"on the phases, which are not given. In phase: {_text(found.mean_ratio)}; least squares "
        f"{_text(found.least_squares)}.",
    )


def _final() -> ReproducedValue:
    printed = [*SINES, *(tuple(print_.split(", ")) for _, print_ in FIGURE), WHOLE]
    means = np.array([[float(k) for k in row] for row in printed]).mean(axis=0)
    return misprint(
        "K_corr of the controller, mean of table 3.5",
        "3.39",
        FINAL,
        tuple(map(float, means)),
        "",
        Tolerance(1e-4),
        right=("1.8273", "1.8239", "2.2204"),
        note="The columns of table 3.5 have other means.",
    )


def _tilt(
    degrees: float, section: str, sides: tuple[str, str], middle: str
) -> tuple[ReproducedValue, ReproducedValue]:
    tilted = robot().tilted(float(np.radians(degrees)))
    depth = correction_coefficients(tilted, DEPTH_SINES)
    angles = correction_coefficients(tilted, TABLE_3_5)
    name = f"K_corr,1 and K_corr,2 at theta4 = {degrees:g} deg"
    found, limit = _ratios(depth)[:2], Tolerance(5e-3)
    return (
        reproduced(name, section, sides, found, "", limit)
        if meets_standard(found, sides)
        else near(name, section, sides, found, "", limit, note=_AXIAL),
        omitted(
            f"K_corr,3 at theta4 = {degrees:g} deg",
            section,
            middle,
            "",
            f"{_FIGURE} Sines of the depth alone give {depth.mean_ratio[2]:.3f}, those of table "
            f"3.5 {angles.mean_ratio[2]:.3f}.",
        ),
    )


def _ratios(found: Correction) -> tuple[float, ...]:
    return tuple(map(float, found.mean_ratio))


def _text(numbers: object) -> str:
    return ", ".join(f"{number:.4f}" for number in np.ravel(np.asarray(numbers, dtype=float)))
