"""Chapters 3.4 and 3.5: correction coefficients of the simplified model."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from nrs_design.robot.models.correction import (
    DEPTH_SINES,
    TABLE_3_5,
    WHOLE_WORKSPACE,
    Correction,
    correction_coefficients,
)
from nrs_design.robot.models.neuroboscope import robot
from nrs_design.thesis.comparison import Recomputed, printed_rows_of

# theta4 in deg of tables 3.7 and of 4.19.
TILTS = (-10.0, -28.5, -40.0, -70.0)


def results() -> Iterator[Recomputed]:
    """Recompute tables 3.5 and 3.7 along slow sines in phase."""
    for sine in TABLE_3_5:
        yield Recomputed(_ratios(correction_coefficients(robot(), sine)))
    found = correction_coefficients(robot(), WHOLE_WORKSPACE)
    yield Recomputed(facts=(_text(found.mean_ratio), _text(found.least_squares)))
    table = [row.printed for row in printed_rows_of("correction") if row.section == "table 3.5"]
    texts = (row.split(", ") if isinstance(row, str) else row for row in table)
    means = np.array([[float(k) for k in row] for row in texts]).mean(axis=0)
    yield Recomputed(tuple(map(float, means)))
    for degrees in TILTS:
        tilted = robot().tilted(float(np.radians(degrees)))
        depth = correction_coefficients(tilted, DEPTH_SINES)
        angles = correction_coefficients(tilted, TABLE_3_5)
        yield Recomputed(_ratios(depth)[:2])
        yield Recomputed(facts=tuple(f"{found.mean_ratio[2]:.3f}" for found in (depth, angles)))


def _ratios(found: Correction) -> tuple[float, ...]:
    return tuple(map(float, found.mean_ratio))


def _text(numbers: object) -> str:
    return ", ".join(f"{number:.4f}" for number in np.ravel(np.asarray(numbers, dtype=float)))
