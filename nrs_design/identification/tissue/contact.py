"""Detection of contact: air before and after, several touches, loss at withdrawal.

In air the force stays while the probe moves; in contact it rises. The position of contact is the
corner of a curve that is flat on one side, found by least squares over a grid of corners.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from nrs_design.identification.datasets.records import TissueRecord
from nrs_design.identification.numeric import Array, Flags, runs, smoothed
from nrs_design.identification.statistics import independent

_GRID = 50
_COARSE = 500
_REFINED = 3
_FINE = 15
_RIDGE = 1e-9
_CYCLES = 4
# Terms of the curve behind the corner.
_BASIC, _FULL = 4, 5
# Least air, as a part of the travel and in samples.
_LEAST_AIR = 0.01
_FEWEST = 10
# Largest ratio of the slope of the force in air to that in contact.
_FLAT = 0.3
# Least decrease of n log(SSE) by a corner against a smooth curve, for n independent samples, and
# least explained fraction of the squared force.
_BETTER = 20.0
_EXPLAINED = 0.1
# Quantile of chi^2 with one degree of freedom at 99 %.
_PLAUSIBLE = 6.635
# Standard deviations by which a smoothed force in contact differs from the air.
_CLEAR = 5.0
_SMOOTH = 5
# A turn counts where the deflection comes back by this part of its range.
_TURN = 0.3


@dataclass(frozen=True, slots=True)
class Touch:
    """Rows of one touch."""

    first: int  # First row beyond the position of contact
    # force_begin, force_end: first row with force, and end of the rows with force. A deformed
    # tissue is touched beyond the position of contact, and separates before the probe returns to
    # this position.
    force_begin: int
    force_end: int
    end: int  # End of the rows beyond the position of contact


@dataclass(frozen=True, eq=False)
class DetectedContact:
    """Which samples are in contact."""

    zero: float  # Position of contact, m (rad); the deflection is counted from it
    # Ends of the 99 % interval of the position of contact, relative to it, into the tissue.
    ends: tuple[float, float]
    side: int  # 1 if the tissue is where positions are larger, else -1
    tissue_side: Flags  # Shape (n,). Beyond the position of contact.
    clear: Flags  # Shape (n,). With a force that clearly differs from the air.

    @cached_property
    def touches(self) -> tuple[Touch, ...]:
        """How often and when the probe meets the tissue."""
        found = []
        for first, end in runs(self.tissue_side):
            clear = np.flatnonzero(self.clear[first:end])
            if len(clear):
                rows = first, first + int(clear[0]), first + int(clear[-1]) + 1, end
                found.append(Touch(*rows))
        return tuple(found)


@dataclass(frozen=True, slots=True)
class _Corner:
    """Position at which the force of one insertion leaves the force in air."""

    # position, low, high: position, and its 99 % interval.
    position: float
    low: float
    high: float
    gain: float  # What n log(SSE) gains against a smooth curve without a corner
    flat: bool  # Whether the force is constant before the corner, which explains enough


def find_contact(record: TissueRecord) -> DetectedContact | None:
    """Find the position of contact; None if the record shows no air."""
    x, force = record.motion.deflection, record.force
    velocity = smoothed(record.motion.velocity, _SMOOTH)
    corners: dict[int, list[_Corner]] = {1: [], -1: []}
    for cycle in find_cycles(x)[:_CYCLES]:
        for side, row in corners.items():
            row += _corner(*_insertion(side * x, side * velocity, force, cycle))
        # Independent touches add up what they tell of air.
        gain, side = max(
            (sum(max(c.gain, 0.0) for c in row if c.flat), side) for side, row in corners.items()
        )
        if gain >= _BETTER:
            # A touch may meet a tissue that has not come back: the least position tells best.
            likely = (c for c in corners[side] if c.flat or c.gain >= _PLAUSIBLE)
            corner = min(likely, key=lambda c: c.position)
            tissue_side = side * x > corner.position
            ends = corner.low - corner.position, corner.high - corner.position
            clear = _clear(force, tissue_side)
            return DetectedContact(side * corner.position, ends, side, tissue_side, clear)
    return None


def _insertion(u: Array, velocity: Array, force: Array, cycle: slice) -> tuple[Array, Array, Array]:
    """Return the samples of the insertion: a relaxing tissue separates at another position."""
    rows = np.arange(len(u))[cycle]
    insertion = rows[velocity[cycle] > 0.02 * np.abs(velocity[cycle]).max()]
    rows = insertion if len(insertion) >= 5 * _FEWEST else rows
    rows = rows[:: -(-len(rows) // _COARSE)]
    return u[rows], velocity[rows], force[rows]


def _corner(u: Array, velocity: Array, force: Array) -> Iterator[_Corner]:
    """Yield the best corner, if there are samples on both sides of it."""
    low, span = float(u.min()), float(np.ptp(u))
    # Between 0 and 1, powers are well conditioned.
    v, centered = (u - low) / span, force - force.mean()
    curve, best, error = _best_corner(v, velocity, centered)
    air = v < best
    if min(air.sum(), (~air).sum()) < _FEWEST or best < _LEAST_AIR:
        return
    smooth = float(_errors(curve, v[None], velocity, centered)[0])
    count = independent(_residuals(curve, np.maximum(v - best, 0.0), velocity, centered))
    grid = np.linspace(0.0, 1.0, 2 * _GRID)
    errors = _errors(curve, np.maximum(v - grid[:, None], 0.0), velocity, centered)
    # Likelihood-ratio interval; a step more than what the grid shows.
    candidates = grid[errors < error * np.exp(_PLAUSIBLE / count)]
    ends = [best, *candidates - grid[1], *candidates + grid[1]]
    position, first, last = (float(low + part * span) for part in (best, min(ends), max(ends)))
    explained = error <= (1 - _EXPLAINED) * float(centered @ centered)
    flat = explained and _is_flat(u, force, position)
    yield _Corner(position, first, last, count * float(np.log(smooth / error)), flat)


def _best_corner(v: Array, velocity: Array, force: Array) -> tuple[int, float, float]:
    """Return the curve, its best corner between 0 and 1, and its squared error.

    Damping that grows with the deflection must be clear: without it, its curve is too free.
    """
    basic, grows = (_corner_of(curve, v, velocity, force) for curve in (_BASIC, _FULL))
    left = _residuals(_BASIC, np.maximum(v - basic[1], 0.0), velocity, force)
    clear = basic[2] > grows[2] * np.exp(_BETTER / independent(left))
    return grows if clear else basic


def _corner_of(curve: int, v: Array, velocity: Array, force: Array) -> tuple[int, float, float]:
    grid = np.linspace(0.5 * _LEAST_AIR, 0.95, _GRID)
    step = float(grid[1] - grid[0])
    for _ in range(_REFINED):
        errors = _errors(curve, np.maximum(v - grid[:, None], 0.0), velocity, force)
        index = int(np.argmin(errors))
        best, error = float(grid[index]), float(errors[index])
        grid = np.linspace(max(best - step, 0.0), min(best + step, 1.0), _FINE)
        step = float(grid[1] - grid[0])
    return curve, best, error


def _errors(curve: int, w: Array, velocity: Array, force: Array) -> Array:
    """Squared errors of a curve that leaves a constant where w leaves zero, shape (m,) for corners.

    The curve is quadratic, with a force in proportion to the velocity that begins with a jump, and
    perhaps one that grows with the deflection, too. Deflections w, shape (m, n), are from 0 to 1.
    """
    residual = _residuals(curve, w, velocity, force)
    return np.asarray(np.einsum("...n,...n->...", residual, residual))


def _residuals(curve: int, w: Array, velocity: Array, force: Array) -> Array:
    """Return the residual force of such curves, of the shape of w."""
    terms = [np.ones_like(w), w, w**2, velocity * (w > 0), velocity * w]
    X = np.stack(terms[:curve], axis=-2)
    X /= np.maximum(np.linalg.norm(X, axis=-1, keepdims=True), np.finfo(float).tiny)
    gram = X @ X.swapaxes(-1, -2) + _RIDGE * np.eye(curve)
    found = np.linalg.solve(gram, (X @ force)[..., None])
    return np.asarray(force - (found.swapaxes(-1, -2) @ X)[..., 0, :])


def _is_flat(u: Array, force: Array, corner: float) -> bool:
    """Tell whether the force stays in air: a slope that is small against that of the contact."""
    air = u < corner
    depth = u - u.mean()
    centered = depth[air] - depth[air].mean()
    slope = float(centered @ force[air]) / max(float(centered @ centered), np.finfo(float).tiny)
    noise = force[air] - force[air].mean() - slope * centered
    error = float(np.sqrt(np.mean(noise**2) / max(float(centered @ centered), 1e-300)))
    rise = float(np.abs(force[~air] - force[air].mean()).max()) / float(u.max() - corner)
    return abs(slope) + 2 * error < _FLAT * rise


def inner(touching: Flags) -> Flags:
    """Leave out the samples at both ends of every touch, whose noise decided where it ends.

    A touch ends where the mean of some samples is no longer clear of the air: among those samples,
    errors are not of mean zero, and some may be air.
    """
    padded = np.pad(touching, _SMOOTH // 2 + 1)
    windows = np.lib.stride_tricks.sliding_window_view(padded, 2 * (_SMOOTH // 2 + 1) + 1)
    return np.asarray(windows.all(axis=1))


def _clear(force: Array, tissue_side: Flags) -> Flags:
    """Flag samples whose force clearly differs from the force in air."""
    air = force[~tissue_side]
    noise = float(np.std(air)) / np.sqrt(_SMOOTH)
    distance = np.abs(smoothed(force, _SMOOTH) - float(np.median(air)))
    return np.asarray(tissue_side & (distance > _CLEAR * noise))


def find_cycles(deflection: Array) -> tuple[slice, ...]:
    """Return the rows of each cycle of loading and unloading.

    Together they are all rows; there is one at least.
    """
    lows = _lows(deflection, _TURN * float(np.ptp(deflection)))
    edges = [0, *lows, len(deflection)]
    return tuple(slice(a, b) for a, b in pairwise(edges))


def _lows(values: Array, threshold: float) -> list[int]:
    """Return the rows between a large fall and a large rise, where it is lowest."""
    lows: list[int] = []
    low_row, high_row, rising = 0, 0, True
    values_list = values.tolist()
    for row, value in enumerate(values_list):
        if rising:
            high_row = row if value >= values_list[high_row] else high_row
            if values_list[high_row] - value > threshold:
                rising, low_row = False, row
        else:
            # The last of equal rows: a cycle begins with its load.
            low_row = row if value <= values_list[low_row] else low_row
            if value - values_list[low_row] > threshold:
                lows.append(low_row)
                rising, high_row = True, row
    return lows


def surface(
    time: Array, position: Array, contacts: Sequence[Touch], threshold: float
) -> tuple[Array, Flags]:
    """Return the deflection of the tissue, touched or not, and the samples in contact.

    A tissue that relaxes is lost before the probe is back where it was met: its surface creeps back
    without force, exponentially in time for every linear law with one relaxation. Loss and next
    touch are two points of that curve, so that it needs no parameter of the law. Positions are in m
    (rad) from the contact; below the least deflection the tissue counts as come back.
    """
    deflection, touching = np.zeros(len(time)), np.zeros(len(time), bool)
    # Depth at which noise lets the force show: the first touch meets a tissue at rest.
    depth = max(float(position[contacts[0].force_begin]), 0.0) + threshold if contacts else 0.0
    separation, since = 0.0, 0
    for touch in contacts:
        contact_depth, left = (
            float(position[touch.force_begin]),
            float(position[touch.force_end - 1]),
        )
        is_deeper = separation > 0 and contact_depth > depth
        # Only a force shows that a separated tissue has come back.
        begin = touch.force_begin if separation > 0 else touch.first
        rows = slice(begin, touch.force_end if left > depth else touch.end)
        deflection[rows], touching[rows] = position[rows], True
        if separation > 0:
            gap = slice(since, rows.start)
            part = (time[gap] - time[since - 1]) / (time[rows.start] - time[since - 1])
            deflection[gap] = (
                separation
                * ((min(contact_depth, separation) if is_deeper else threshold) / separation)
                ** part
            )
        separation, since = left if left > depth else 0.0, rows.stop
    # The deflection after the last touch has no effect; a jump would be a velocity.
    deflection[since:] = separation
    return np.maximum(deflection, 0.0), touching
