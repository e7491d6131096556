"""What was measured, shown and never asserted; and what follows from the printed measurements."""

from __future__ import annotations

from collections.abc import Iterable
from math import degrees
from statistics import fmean

from nrs_design.thesis.comparison import Found
from nrs_design.thesis.interaction import DESIRED

# Times in s without and with switching, by experiment of 6.3.2.3.
TIMES = ((0.75, 0.61), (0.53, 0.41), (0.09, 0.07), (0.16, 0.13))
# Displayed impedances of 6.3.1.2, three of phi and three of psi, N m s/rad.
DISPLAYED = (2.1372, 2.0997, 2.1766, 2.0494, 2.0883, 2.1131)


def results() -> Iterable[Found]:
    """List the measurements, and recompute what the thesis says of them."""
    gains = tuple(100 * (1 - fast / slow) for slow, fast in TIMES)
    return (
        tuple(100 * (shown / DESIRED - 1) for shown in DISPLAYED),
        (degrees(0.0873), degrees(0.0524)),
        gains,
        fmean(gains),
    )
