"""Chapters 3.4 and 3.5: correction coefficients of the simplified model."""

from __future__ import annotations

import numpy as np

from nrs_design.robot.models import Correction, correction_coefficients
from nrs_design.robot.models.correction import DEPTH_SINES, TABLE_3_5, WHOLE_WORKSPACE, Sine
from nrs_design.robot.models.neuroboscope import robot
from nrs_design.thesis.comparison import (
    ReproducedValue,
    Tolerance,
    fitted,
    misprint,
    near,
    omitted,
)

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
# theta4 in deg, section, K1 and K2, what we compute for them, K3.
TILTS = (
    (-10.0, "table 3.7", ("1.83", "1.83"), ("1.82959", "1.82597"), "2.18"),
    (-28.5, "4.19", ("1.848", "1.845"), ("1.84500", "1.84195"), "2.152"),
    (-40.0, "table 3.7", ("1.85", "1.85"), ("1.85390", "1.85120"), "2.12"),
    (-70.0, "table 3.7", ("1.88", "1.88"), ("1.88159", "1.87994"), "1.9"),
)
# What we compute for `SINES`.
OURS = (
    ("1.82288", "1.81895", "2.28215"),
    ("1.82188", "1.81773", "2.28709"),
    ("1.82130", "1.81751", "2.28346"),
    ("1.82154", "1.81488", "2.28803"),
    ("1.82272", "1.81881", "2.22417"),
    ("1.82377", "1.81969", "2.22538"),
    ("1.82066", "1.81620", "2.22448"),
    ("1.82162", "1.81690", "2.22559"),
    ("1.81277", "1.80862", "2.19511"),
    ("1.81422", "1.80988", "2.19331"),
    ("1.81008", "1.80460", "2.19476"),
    ("1.80969", "1.80708", "2.19274"),
)
_LIMIT = Tolerance(1e-5)
_FIGURE = "the trajectory of figure 3.7 is not in the text"
AXIAL = "axial offset of the platform's center of mass, 10 mm beyond d"


def rows() -> tuple[ReproducedValue, ...]:
    """Recompute tables 3.5 and 3.7 along slow sines in phase."""
    sines = (_sine(*entry) for entry in zip(TABLE_3_5, SINES, OURS, strict=True))
    figure = (
        omitted(
            f"K_corr along figure 3.7, d {d} mm", "table 3.5", print_, "", _FIGURE, ("figure 3.7",)
        )
        for d, print_ in FIGURE
    )
    tilts = (row for tilt in TILTS for row in _tilt(*tilt))
    return (*sines, *figure, _whole(), _final(), *tilts)


def _sine(sine: Sine, printed: tuple[str, str, str], ours: tuple[str, str, str]) -> ReproducedValue:
    low, high = (1e3 * d for d in sine.d)
    return near(
        f"K_corr, phi {sine.phi:g}, psi {sine.psi:g} rad, d {low:.0f} - {high:.0f} mm",
        "table 3.5",
        printed,
        _ratios(correction_coefficients(robot(), sine)),
        "",
        _LIMIT,
        right=ours,
        constants=AXIAL,
        because="periods, phases and samples of the sines and the inertias of the links are not "
        "printed",
        note="Slow sines in phase and slender rods come this near. On a level base the axial "
        "offset changes the coefficients by less than 0.02 %.",
    )


def _whole() -> ReproducedValue:
    found = correction_coefficients(robot(), WHOLE_WORKSPACE)
    return omitted(
        "K_corr over the whole workspace",
        "table 3.5",
        ", ".join(WHOLE),
        "",
        "some of the ratios are of two values near zero, so their mean hangs on samples and "
        f"phases, which are not printed; in phase: {_text(found.mean_ratio)}; least squares "
        f"{_text(found.least_squares)}",
        ("table 3.5",),
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
        errata=("3.39",),
    )


def _tilt(
    degrees: float,
    section: str,
    sides: tuple[str, str],
    ours: tuple[str, str],
    middle: str,
) -> tuple[ReproducedValue, ReproducedValue]:
    tilted = robot().tilted(float(np.radians(degrees)))
    depth = correction_coefficients(tilted, DEPTH_SINES)
    angles = correction_coefficients(tilted, TABLE_3_5)
    name = f"K_corr,1 and K_corr,2 at theta4 = {degrees:g} deg"
    return (
        fitted(
            name,
            section,
            sides,
            _ratios(depth)[:2],
            "",
            _LIMIT,
            right=ours,
            constants=AXIAL,
            note="Slow sines of the depth. 6 to 12 mm fit as well, which move them by up to 0.4 %.",
        ),
        omitted(
            f"K_corr,3 at theta4 = {degrees:g} deg",
            section,
            middle,
            "",
            f"{_FIGURE}; sines of the depth alone give {depth.mean_ratio[2]:.3f}, those of table "
            f"3.5 {angles.mean_ratio[2]:.3f}",
            ("table 3.7",),
        ),
    )


def _ratios(found: Correction) -> tuple[float, ...]:
    return tuple(map(float, found.mean_ratio))


def _text(numbers: object) -> str:
    return ", ".join(f"{number:.4f}" for number in np.ravel(np.asarray(numbers, dtype=float)))
