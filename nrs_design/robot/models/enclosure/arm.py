"""The mobility of an arm over a box of joint positions, rigorously.

Over each box, Jacobian and mass matrix are their values at the middle and slopes that hold all over
it. That the eigenvalues of ``J0^(1/2) J M^-1 J' J0^(1/2)`` are in [l, u] is that

    M - J' J0 J/u >= 0    and    J X + X'J' - X'M X - l J0^-1 >= 0

for any X; with ``X = M^-1 J'`` of the middle, the second is lossless there. Neither has an inverse.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from nrs_design.robot.models.arm import (
    ArmJoint,
    ArmTree,
    Floats,
    cross_matrix,
    cross_motion,
    joint_axis,
    motion_transform,
)
from nrs_design.robot.models.enclosure.balls import OUTWARD, TINY, UNIT
from nrs_design.work import Allowance, Cost

Bools: TypeAlias = NDArray[np.bool_]
Places: TypeAlias = NDArray[np.intp]

# Numbers of a URDF, and cosines, are off by far less, relative to the largest of a matrix.
READ = 2.0**-40
BATCH = 2048
# Of work, for a box and a joint squared.
WORK = 3e-6


@dataclass(frozen=True)
class BallMatrix:
    """Stacks of matrices: midpoints and radii, of one shape."""

    mid: Floats
    rad: Floats

    @classmethod
    def known(cls, mid: Floats, share: float = READ) -> BallMatrix:
        """Return matrices whose entries are off by a share of the largest one."""
        size = np.abs(mid).max(axis=(-2, -1), keepdims=True) if mid.size else mid
        return cls(mid, np.broadcast_to(share * size, mid.shape))

    @classmethod
    def exact(cls, mid: Floats) -> BallMatrix:
        """Return matrices of floats that are meant as they are."""
        return cls(mid, np.zeros_like(mid))

    @property
    def T(self) -> BallMatrix:
        """The transposed matrices."""
        return BallMatrix(np.swapaxes(self.mid, -1, -2), np.swapaxes(self.rad, -1, -2))

    @property
    def size(self) -> Floats:
        """Not below the magnitude of any entry."""
        return np.asarray((np.abs(self.mid) + self.rad) * OUTWARD)

    def __add__(self, other: BallMatrix) -> BallMatrix:
        """Return the sum."""
        mid = self.mid + other.mid
        return BallMatrix(mid, (self.rad + other.rad + UNIT * np.abs(mid)) * OUTWARD)

    def __neg__(self) -> BallMatrix:
        """Return the opposite."""
        return BallMatrix(-self.mid, self.rad)

    def __matmul__(self, other: BallMatrix) -> BallMatrix:
        """Return the product; a sum of n products is off by 2 n roundings at most, in any order."""
        mid, n = self.mid @ other.mid, self.mid.shape[-1]
        sizes = np.abs(self.mid), np.abs(other.mid)
        rad = sizes[0] @ other.rad + self.rad @ (sizes[1] + other.rad)
        rad = rad + 2 * n * UNIT * (sizes[0] @ sizes[1])
        # The radii are sums of so many terms, too.
        return BallMatrix(mid, rad * (1 + 8 * n * UNIT) * OUTWARD + TINY)

    def __getitem__(self, place: Any) -> BallMatrix:
        """Return a part."""
        return BallMatrix(self.mid[place], self.rad[place])


@dataclass(frozen=True)
class Slopes:
    """Matrices over boxes: at the middle, all over each box, and their slopes all over it.

    Shapes (b, r, c), and (k, b, r, c) for the slopes by the joints of which there are k.
    """

    middle: BallMatrix
    whole: BallMatrix
    slopes: BallMatrix

    @classmethod
    def of(cls, middle: BallMatrix, slopes: BallMatrix, half: Floats) -> Slopes:
        """Return what follows all over the boxes by the mean value theorem.

        Parameters
        ----------
        middle, slopes : BallMatrix
            As for the class.
        half : array, shape (k, b)
            Half the widths of the boxes.
        """
        moved = (slopes.size * half[..., None, None]).sum(axis=0)
        n = len(half)
        rad = (middle.rad + moved * (1 + 4 * n * UNIT)) * OUTWARD + TINY
        return cls(middle, BallMatrix(middle.mid, rad), slopes)

    def around(self, weight: BallMatrix, half: Floats) -> Slopes:
        """Return ``A' W A``, for a W that is symmetric and constant."""
        middle = self.middle.T @ weight @ self.middle
        half_slopes = self.slopes.T @ (weight @ self.whole)
        return Slopes.of(middle, half_slopes + half_slopes.T, half)

    def plus(self, other: Slopes, half: Floats) -> Slopes:
        """Return the sum."""
        return Slopes.of(self.middle + other.middle, self.slopes + other.slopes, half)


def shown_between(
    arm: ArmTree,
    inertias: Floats,
    axes: list[int],
    low: float,
    high: float,
    boxes: tuple[Floats, Floats],
) -> tuple[Bools, Places]:
    """Tell in which boxes the mobility is shown to be in a range, and where to halve the others.

    Parameters
    ----------
    arm : ArmTree
        The arm.
    inertias : array, shape (k,)
        The J of the axes, in kg or kg m^2.
    axes : list of int
        As for `mobility`.
    low, high : float
        The range.
    boxes : tuple of array, shape (n, b)
        Lowest and highest joint positions.

    Returns
    -------
    array of bool, shape (b,)
        Whether it is shown.
    array of int, shape (b,)
        The joint across which to halve.
    """
    lows, highs = boxes
    middle = (lows + highs) / 2
    half = np.maximum(highs - middle, middle - lows) * OUTWARD
    J, M = enclosed_over(arm, axes, middle, half)
    weight = BallMatrix.known(np.diag(inertias))
    # What is rounded in 1/u and l is as small as what reading rounds.
    heavy = J.around(BallMatrix.known(np.diag(inertias / high)), half)
    under = Slopes.of(M.middle + -heavy.middle, M.slopes + -heavy.slopes, half)
    X = BallMatrix.exact(
        np.asarray(np.linalg.solve(M.middle.mid, np.swapaxes(J.middle.mid, -1, -2)))
    )
    JX, slope = J.middle @ X, J.slopes @ X
    XMX, XsX = X.T @ M.middle @ X, X.T @ M.slopes @ X
    floor = BallMatrix.known(np.diag(low / np.diag(weight.mid)))
    over = Slopes.of(JX + JX.T + -XMX + -floor, slope + slope.T + -XsX, half)
    shown = np.ones(lows.shape[1], bool)
    pull = np.zeros_like(half)
    for form in (under, over):
        positive, pulls = _positive(form, half)
        shown &= positive
        pull = np.maximum(pull, pulls)
    return shown, np.argmax(pull, axis=0)


def _positive(form: Slopes, half: Floats) -> tuple[Bools, Floats]:
    """Tell where a symmetric form is positive definite, and how far each joint takes it at most.

    With C the inverse root of the middle, ``C F C' = I + E``; where every row of ``|E|`` has a sum
    below 1, that is positive definite, and so is F.
    """
    mid = form.middle.mid
    values, vectors = np.linalg.eigh(mid)
    scale = 1 / np.sqrt(np.where(values > 0, values, 1.0))
    # Symmetric, so that rows of errors are as small as can be.
    root = (vectors * scale[:, None, :]) @ np.swapaxes(vectors, -1, -2)
    C = BallMatrix.exact(root)
    inner = (C @ form.middle @ C.T) + -BallMatrix.exact(
        np.broadcast_to(np.eye(mid.shape[-1]), mid.shape)
    )
    moved = (C @ form.slopes @ C.T).size * half[..., None, None]
    n = len(half)
    error = (inner.size + moved.sum(axis=0) * (1 + 4 * n * UNIT)) * OUTWARD
    rows = error.sum(axis=-1) * (1 + 4 * mid.shape[-1] * UNIT)
    # The eigenvalues stay those where a row is scaled and its column scaled back.
    weights = np.sqrt(rows) + TINY
    scaled = (error * weights[:, None, :]).sum(axis=-1) / weights * (1 + 1e-12)
    largest = np.minimum(rows.max(axis=-1), scaled.max(axis=-1))
    # What is positive definite after C is so before it, whatever C is.
    return largest < 1, moved.sum(axis=-1).max(axis=-1)


def enclosed_over(
    arm: ArmTree, axes: list[int], middle: Floats, half: Floats
) -> tuple[Slopes, Slopes]:
    """Return the Jacobian of the tip in some of its directions, and the mass matrix, over boxes.

    Parameters
    ----------
    arm : ArmTree
        The arm.
    axes : list of int
        As for `mobility`.
    middle, half : array, shape (n, b)
        Joint positions at the middles of the boxes, and half their widths.
    """
    n, b = middle.shape
    found: list[Slopes] = []
    M: Slopes | None = None
    zero = BallMatrix(np.zeros((b, 6, n)), np.zeros((b, 6, n)))
    still = BallMatrix(np.zeros((n, b, 6, n)), np.zeros((n, b, 6, n)))
    for i, joint in enumerate(arm.joints):
        before = found[joint.parent] if joint.parent >= 0 else Slopes(zero, zero, still)
        X, Xw = _joint_motion(joint, middle[i], half[i])
        J = X @ before.middle
        column = np.zeros((6, n))
        column[:, i] = joint_axis(joint)
        J = J + BallMatrix(np.broadcast_to(column, J.mid.shape), np.full(J.mid.shape, READ))
        slopes = Xw @ before.slopes
        # The body turns by its own joint: what came before it is seen turned back.
        back = BallMatrix.known(-cross_motion(joint_axis(joint))) @ (Xw @ before.whole)
        slopes = BallMatrix(slopes.mid.copy(), slopes.rad.copy())
        slopes.mid[i], slopes.rad[i] = back.mid, back.rad
        found.append(Slopes.of(J, slopes, half))
        part = found[-1].around(BallMatrix.known(joint.inertia), half)
        M = part if M is None else M.plus(part, half)
    assert M is not None
    armature = BallMatrix.known(np.diag([joint.armature for joint in arm.joints]))
    M = Slopes.of(M.middle + armature, M.slopes, half)
    tip = BallMatrix.known(motion_transform(arm.tip_rotation, arm.tip_place))
    last = found[arm.tip]
    rows = [(axis + 3) % 6 for axis in axes]
    moved = Slopes.of(tip @ last.middle, tip @ last.slopes, half)
    chosen = (slice(None), rows)
    return (
        Slopes(moved.middle[chosen], moved.whole[chosen], moved.slopes[:, :, rows]),
        M,
    )


def _joint_motion(joint: ArmJoint, q: Floats, half: Floats) -> tuple[BallMatrix, BallMatrix]:
    """Return the motion transform of a joint at the middle and all over each box."""
    fixed = BallMatrix.known(motion_transform(joint.rotation, joint.place))
    a = cross_matrix(joint.axis)
    E = np.eye(6)
    if joint.slides:
        slide = np.zeros((6, 6))
        slide[3:, :3] = -a
        middle = E + q[:, None, None] * slide
        # The product rounds once.
        own = BallMatrix.known(middle)
        reach = half[:, None, None] * np.abs(slide)
    else:
        turn = np.zeros((6, 6))
        turn[:3, :3] = turn[3:, 3:] = a
        square = turn @ turn
        cos, sin = np.cos(q)[:, None, None], np.sin(q)[:, None, None]
        own = BallMatrix.known(E - sin * turn + (1 - cos) * square)
        # While the angle turns by h, sine and cosine go at most |cos| h + h^2/2 and so on.
        h = half[:, None, None]
        goes = [np.minimum(np.abs(part) * h + h * h / 2, h) for part in (cos, sin)]
        reach = goes[0] * np.abs(turn) + goes[1] * np.abs(square)
    whole = BallMatrix(own.mid, (own.rad + reach * (1 + READ)) * OUTWARD + TINY)
    return own @ fixed, whole @ fixed


def cover_mobility(
    arm: ArmTree,
    inertias: Floats,
    axes: list[int],
    goal: tuple[float, float],
    box: tuple[Floats, Floats],
    allowance: Allowance,
    progress: Callable[[int, int], None] = lambda done, left: None,
) -> bool:
    """Halve boxes until the mobility is shown to be in a range in each, or the work is used up.

    Parameters
    ----------
    arm, inertias, axes
        As for `shown_between`.
    goal : tuple of float
        The range.
    box : tuple of array, shape (n,)
        Lowest and highest joint positions.
    allowance : Allowance
        Work.
    progress : callable
        Told how many boxes are done and left.
    """
    lows, highs = (side[:, None] for side in box)
    done = 0
    while lows.shape[1]:
        # The smallest boxes first: what cannot be shown at all is found so early.
        low, high = lows[:, -BATCH:], highs[:, -BATCH:]
        cost = WORK * low.shape[1] * arm.order**2
        if not allowance.affords(Cost(cost)):
            return False
        allowance.charge(cost)
        shown, axis = shown_between(arm, inertias, axes, *goal, (low, high))
        done += int(shown.sum())
        low, high, axis = low[:, ~shown], high[:, ~shown], axis[~shown]
        rows, cut = np.arange(low.shape[1]), (low + high) / 2
        upper, lower = high.copy(), low.copy()
        upper[axis, rows] = lower[axis, rows] = cut[axis, rows]
        lows = np.hstack([lows[:, :-BATCH], low, lower])
        highs = np.hstack([highs[:, :-BATCH], upper, high])
        progress(done, lows.shape[1])
    return True
