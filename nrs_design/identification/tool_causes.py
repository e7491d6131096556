"""Why poses and forces do not fit together: another meaning of the columns that explains them.

All of these are common: the rotation is written the other way round, the wrench is given along the
axes of the world, or the sensor is mounted askew on the frame whose orientation is recorded.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from nrs_design.identification.datasets import PoseRecord
from nrs_design.identification.numeric import Array

# So few poses fit with many causes.
_ENOUGH = 6
# A cause is named where it leaves less than this part of the errors.
_LEAVES = 0.5
# A smaller angle, in rad, is within the tolerance of mounting.
_STRAIGHT = 0.02


def likely_cause(records: Sequence[PoseRecord], errors: Array) -> str | None:
    """Name what would explain the forces far better, with what it leaves; or None.

    Parameters
    ----------
    records : sequence of PoseRecord
        The poses.
    errors : ndarray
        Of the force as it was read, in N.
    """
    if errors.size < 3 * _ENOUGH:
        return None
    left, weight, words = min(_causes(records), default=(math.inf, 1.0, ""))
    if left > _LEAVES * float(np.sqrt(np.mean(errors**2))) or weight <= 0:
        return None
    return f"likely {words}: then it would miss {100 * left / weight:.2g} %"


def _causes(records: Sequence[PoseRecord]) -> Iterator[tuple[float, float, str]]:
    """Yield what each cause leaves, the weight by it, both in N, and its words."""
    down, force = (
        np.concatenate([getattr(r, name) for r in records]) for name in ("down", "force")
    )
    askew, *found = _turned(down, force)
    if askew > _STRAIGHT:
        words = f"the sensor is mounted askew by {math.degrees(askew):.3g} deg"
        yield found[0], found[1], words
    turns = [record.turns for record in records if record.turns is not None]
    if len(turns) < len(records):
        return
    turn = np.concatenate(turns)
    yield *_left(-turn[:, :, 2], force), "the orientation is that of the world in the sensor"
    along = np.einsum("nji,nj->ni", turn, force)
    yield *_left(down, along), "the wrench is given along the axes of the world"


def _left(down: Array, force: Array) -> tuple[float, float]:
    """Return what a weight and a bias along the axes of the sensor leave, and that weight."""
    D, F = down - down.mean(axis=0), force - force.mean(axis=0)
    weight = float(np.sum(D * F) / np.sum(D * D))
    return float(np.sqrt(np.mean((F - weight * D) ** 2))), weight


def _turned(down: Array, force: Array) -> tuple[float, float, float]:
    """Return the angle of the rotation that fits best, what it leaves, and the weight by it."""
    D, F = down - down.mean(axis=0), force - force.mean(axis=0)
    U, _, Vt = np.linalg.svd(F.T @ D)
    Q = U @ np.diag([1.0, 1.0, np.linalg.det(U @ Vt)]) @ Vt
    angle = math.acos(min(max((float(np.trace(Q)) - 1) / 2, -1.0), 1.0))
    return angle, *_left(down @ Q.T, force)
