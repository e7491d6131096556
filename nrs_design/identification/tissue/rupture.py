"""Rupture: the force falls while the probe goes on."""

from __future__ import annotations

import numpy as np

from nrs_design.identification.datasets.checks import gaps_in
from nrs_design.identification.numeric import Array, smoothed
from nrs_design.models.contact import Motion

# The force falls by this part of its range ...
_FALL = 0.15
# ... within this part of the record, and at least so many samples ...
_WINDOW = 0.02
_FEWEST = 3
# ... while the probe goes on at this part of its speed before, or faster: a damper gives way too
# where the probe slows down.
_GOES_ON = 0.9
# And it stays below what it was: the part of the fall that may come back in the next window.
_COMES_BACK = 0.5
# And it is so many times the usual change between two samples.
_NOISE = 5.0
# Before it, the force rises by this part of its range in the same time, and the probe moves.
_GROWTH = 0.02


def find_rupture(motion: Motion, force: Array) -> tuple[int, str] | None:
    """Return the last row before the force falls, and what happens; None if nothing tears."""
    n = len(force)
    window = max(round(_WINDOW * n), _FEWEST)
    if n < 4 * window:
        return None
    x = motion.deflection
    size = smoothed(force - np.median(force[:window]), max(window // 2, 1))
    # Into the tissue, and against it: where the force is largest.
    top = int(np.argmax(np.abs(size)))
    size = size * np.sign(size[top])
    inward = _direction(x[: top + 1], size[: top + 1])
    span = float(np.ptp(size))
    if span == 0.0:
        return None
    rows = np.arange(window, n - 2 * window)
    falls = (size[rows] - size[rows + window]) / span
    stays = (size[rows] - size[rows + 2 * window]) / span > _COMES_BACK * falls
    before, after = x[rows] - x[rows - window], x[rows + window] - x[rows]
    before, after = inward * before, inward * after
    on = (before > _GROWTH / 4 * np.ptp(x)) & (after > _GOES_ON * before)
    grew = size[rows] - size[rows - window] > _GROWTH * span
    noise = float(np.median(np.abs(np.diff(force)))) / span
    # Over a pause of the record, a tissue relaxes unseen.
    paused = np.concatenate([[0], np.cumsum(gaps_in(motion.time))])
    whole = paused[rows + 2 * window] == paused[rows - window]
    hits = rows[(falls > max(_FALL, _NOISE * noise)) & stays & on & grew & whole]
    if not len(hits):
        return None
    first = int(hits[0])
    peak = first + int(np.argmax(size[first : first + window]))
    # Before the peak, a tissue may already give way.
    fall = float(size[peak] - size[peak : peak + 2 * window].min()) / span
    words = f"the force falls by {100 * fall:.0f} % of its range while the probe goes on"
    return peak, f"rupture at {motion.time[peak]:.4g} s: {words}"


def _direction(x: Array, size: Array) -> float:
    """Return the sign of the motion against which the force grows, with its way and its speed.

    Where the force is largest does not tell: a tissue that relaxes may pull most where the probe
    is back at its start.
    """
    way = x - x.mean()
    speed = np.diff(x, prepend=x[0])
    grown = size - size.mean()
    shares = (float(y @ grown) / (float(np.linalg.norm(y)) or 1.0) for y in (way, speed))
    return float(np.sign(sum(shares)))
