"""Where a probe meets the tissue: air before and after, several touches, loss while it pulls back.

In air the force stays while the probe moves; in contact it rises. The position of contact is the
corner of a curve that is flat on one side, found by least squares over a grid of corners.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nrs_design.identification.datasets import TissueRecord

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

_GRID = 50
_COARSE = 500
_REFINED = 3
_FINE = 15
_RIDGE = 1e-9
# Air must be this part of the travel at least, with so many samples.
_LEAST_AIR = 0.01
_FEWEST = 10
# Stiffness of air over that of the contact: what is stiffer is tissue.
_FLAT = 0.1
# The corner must lower the squared error by this factor against a smooth curve without one.
_BETTER = 0.8
_CORNERLESS = 0.9
# Contact is lost where a smoothed force is within so many of its standard deviations from the air.
_LOST = 3.0
_SMOOTH = 5


@dataclass(frozen=True, slots=True, eq=False)
class Contact:
    """Which samples are in contact.

    Parameters
    ----------
    zero : float
        Position of contact, m (rad); the deflection is counted from it.
    side : int
        1 if the tissue is where positions are larger, else -1.
    touching : ndarray of bool, shape (n,)
        Beyond the position of contact.
    lost : ndarray of bool, shape (n,)
        Beyond it, and yet without force: the tissue has not come back yet.
    """

    zero: float
    side: int
    touching: Flags
    lost: Flags

    @property
    def touches(self) -> int:
        """How often the probe meets the tissue."""
        starts = np.flatnonzero(np.diff(self.touching.astype(int)) == 1)
        return len(starts) + int(self.touching[0])


def find_contact(record: TissueRecord) -> Contact | None:
    """Find where contact begins; None if no air shows in the record.

    Parameters
    ----------
    record : TissueRecord
        Position and force in any zero; n samples.
    """
    x, force = record.motion.deflection, record.force
    velocity = _smoothed(record.motion.velocity)
    best: tuple[float, float, int] | None = None
    for side in (1, -1):
        pick = _loading(side * x, side * velocity)
        found = _corner(side * x[pick], force[pick])
        if found is not None and (best is None or found[1] < best[1]):
            best = (*found, side)
    if best is None:
        return None
    corner, _, side = best
    touching = side * x > corner
    lost = _lost(force, touching)
    return Contact(side * corner, side, touching, lost)


def _loading(u: Array, velocity: Array) -> NDArray[np.intp]:
    """Pick samples on the way in: a tissue that relaxes lets go elsewhere than it was met."""
    way_in = np.flatnonzero(velocity > 0.02 * np.abs(velocity).max())
    rows = way_in if len(way_in) >= 5 * _FEWEST else np.arange(len(u))
    return rows[:: -(-len(rows) // _COARSE)]


def _corner(u: Array, force: Array) -> tuple[float, float] | None:
    """Return the best corner and its squared error, if it is one."""
    low, span = float(u.min()), float(np.ptp(u))
    # Between 0 and 1, powers are told apart.
    v, centered = (u - low) / span, force - force.mean()
    grid = np.linspace(0.5 * _LEAST_AIR, 0.95, _GRID)
    step = float(grid[1] - grid[0])
    for _ in range(_REFINED):
        errors = _errors(np.maximum(v - grid[:, None], 0.0), centered)
        at = int(np.argmin(errors))
        best, error = float(grid[at]), float(errors[at])
        grid = np.linspace(max(best - step, 0.0), min(best + step, 1.0), _FINE)
        step = float(grid[1] - grid[0])
    air = v < best
    if min(air.sum(), (~air).sum()) < _FEWEST or best < _LEAST_AIR:
        return None
    smooth = float(_errors(v[None], centered)[0])
    if error > _BETTER * smooth or error > _CORNERLESS * float(centered @ centered):
        return None
    return (low + best * span, error) if _is_flat(u, force, low + best * span) else None


def _errors(w: Array, force: Array) -> Array:
    """Squared errors of a constant and a cubic in w: beyond a corner, w leaves zero; (m, n)."""
    X = np.stack([np.ones_like(w), w, w**2, w**3], axis=2)
    size = np.maximum(np.sqrt(np.einsum("mni,mni->mi", X, X)), np.finfo(float).tiny)
    X /= size[:, None, :]
    gram = np.einsum("mni,mnj->mij", X, X) + _RIDGE * np.eye(4)
    found = np.linalg.solve(gram, np.einsum("mni,n->mi", X, force)[:, :, None])
    rest = force - np.einsum("mni,mi->mn", X, found[:, :, 0])
    return np.asarray(np.einsum("mn,mn->m", rest, rest))


def _is_flat(u: Array, force: Array, corner: float) -> bool:
    """Tell whether the force stays in air: a slope that is small against that of the contact."""
    air = u < corner
    inside = u - u.mean()
    centered = inside[air] - inside[air].mean()
    slope = float(centered @ force[air]) / max(float(centered @ centered), np.finfo(float).tiny)
    noise = force[air] - force[air].mean() - slope * centered
    error = float(np.sqrt(np.mean(noise**2) / max(float(centered @ centered), 1e-300)))
    rise = float(np.abs(force[~air] - force[air].mean()).max()) / float(u.max() - corner)
    return abs(slope) < _FLAT * rise + 3 * error and error < _FLAT * rise


def _lost(force: Array, touching: Flags) -> Flags:
    """Find where the probe is beyond the position of contact without force."""
    air = force[~touching]
    level = float(np.median(air))
    noise = float(np.std(air)) / np.sqrt(_SMOOTH)
    return np.asarray(touching & (np.abs(_smoothed(force) - level) < _LOST * noise))


def _smoothed(values: Array) -> Array:
    padded = np.pad(values, _SMOOTH // 2, mode="edge")
    return np.convolve(padded, np.full(_SMOOTH, 1 / _SMOOTH), "valid")
