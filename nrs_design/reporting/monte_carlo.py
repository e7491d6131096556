"""Many runs in numbers and pictures: peaks, and the share of runs above each limit."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.proof.bounds import lower, upper
from nrs_design.reporting.figures.monte_carlo import Spread, draw_monte_carlo
from nrs_design.simulation.monte_carlo import CONFIDENCE, Outcome, Share
from nrs_design.simulation.peaks import PEAKS

if TYPE_CHECKING:
    from matplotlib.figure import Figure

COLUMNS = ("peak", "median", "largest", "unit", "limit", "above", "share of runs", "95 % interval")
MEANING = (
    f"Intervals are those of Clopper and Pearson at {CONFIDENCE:.0%}, for the share under what was "
    "drawn alone: every parameter and gain uniform in its range, each for itself, and kept for the "
    "run, while a proof lets them move. That is no "
    "statement about the robot's own distribution, and none about the worst case."
)
_SCALES = {
    "torque": (1.0, "N m"),
    "deflection": (180 / math.pi, "deg"),
    "velocity": (180 / math.pi, "deg/s"),
}

Limits = Mapping[str, Mapping[str, float]]


def share_rows(
    outcomes: Sequence[Outcome], limits: Limits, found: Mapping[str, Share]
) -> list[list[str]]:
    """Return rows for `COLUMNS`, peaks rounded up.

    Parameters
    ----------
    outcomes : sequence of Outcome
        Of all runs.
    limits : mapping of str to mapping of str to float
        For each scenario, the limits of quantities.
    found : mapping of str to Share
        Runs above them.
    """
    rows = []
    for name in PEAKS:
        factor, unit = _SCALES[name]
        peaks = factor * np.array([one.peaks[name] for one in outcomes])
        cells = [name, f"{np.median(peaks):.4g}", upper(Fraction(float(peaks.max())), 4), unit]
        share = found.get(name)
        if share is None:
            rows.append([*cells, "–", "–", "–", "–"])
            continue
        known = sorted({factor * each[name] for each in limits.values() if name in each})
        ends = f"{_percent(share.low, lower)} to {_percent(share.high, upper)}"
        counted = f"{share.above} of {share.runs}"
        listed = ", ".join(f"{value:.4g}" for value in known)
        rows.append([*cells, listed, counted, f"{100 * share.value:.4g} %", ends])
    return rows


def draw_outcomes(
    outcomes: Sequence[Outcome],
    limits: Limits,
    bounds: Mapping[str, tuple[float, bool]],
) -> Figure:
    """Draw the peaks of all runs.

    Parameters
    ----------
    outcomes, limits
        As for `share_rows`.
    bounds : mapping of str to tuple of (float, bool)
        Certified bounds in SI, and whether they are about all these runs.
    """
    spreads = []
    for name in PEAKS:
        factor, unit = _SCALES[name]
        known = sorted({factor * each[name] for each in limits.values() if name in each})
        level, holds = bounds.get(name, (None, False))
        spreads.append(
            Spread(
                f"Largest {name} [{unit}]",
                factor * np.array([one.peaks[name] for one in outcomes]),
                tuple(known),
                None if level is None else factor * level,
                holds,
            )
        )
    return draw_monte_carlo(spreads)


def outcomes_table(outcomes: Sequence[Outcome]) -> str:
    """Return a table with a row for each run, in SI."""
    names = list(dict.fromkeys(name for one in outcomes for name in one.parameters))
    units = {"torque": "Nm", "deflection": "rad", "velocity": "rad_s"}
    peaks = [f"peak_{name}_{unit}" for name, unit in units.items()]
    lines = [",".join(["run", "scenario", "seed", *peaks, "stopped", *map(_column, names)])]
    for one in outcomes:
        drawn = (repr(one.parameters[name]) if name in one.parameters else "" for name in names)
        sizes = (repr(one.peaks[name]) for name in units)
        whole = str(int(one.stopped is not None))
        lines.append(",".join([str(one.index), one.scenario, str(one.seed), *sizes, whole, *drawn]))
    return "\n".join(lines) + "\n"


def _column(name: str) -> str:
    return name.replace(" ", "-")


def _percent(share: float, rounded: Callable[[Fraction, int], str]) -> str:
    return f"{rounded(Fraction(share) * 100, 3)} %"
