"""The largest value over a box of poses: boxes are halved until each is below a goal."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nrs_design.robot.models.enclosure.balls import OUTWARD, Floats
from nrs_design.work import Allowance, Cost

# Boxes that are treated at once: enough that NumPy computes, and Python only calls it.
BATCH = 4096


@dataclass(frozen=True)
class Boxes:
    """Boxes of poses: the lowest and the highest coordinates of each, shapes (3, n)."""

    low: Floats
    high: Floats

    @property
    def count(self) -> int:
        """How many there are."""
        return int(self.low.shape[1])

    @property
    def middle(self) -> Floats:
        """A point in each."""
        return np.asarray((self.low + self.high) / 2)

    @property
    def half(self) -> Floats:
        """How far from the middle any point of a box is at most."""
        middle = self.middle
        return np.asarray(np.maximum(self.high - middle, middle - self.low) * OUTWARD)

    def part(self, which: NDArray[np.bool_] | slice) -> Boxes:
        """Return some of them."""
        return Boxes(self.low[:, which], self.high[:, which])

    def halved(self, axis: Floats) -> Boxes:
        """Return both halves of each, cut across one coordinate of its own."""
        rows, cut = np.arange(self.count), self.middle
        high, low = self.high.copy(), self.low.copy()
        high[axis, rows] = low[axis, rows] = cut[axis, rows]
        return Boxes(np.hstack([self.low, low]), np.hstack([high, self.high]))


def cut(low: Floats, high: Floats, widest: tuple[float, float, float]) -> Boxes:
    """Return the boxes that one box is cut into, side by side.

    Parameters
    ----------
    low, high : array, shape (3,)
        Of the box.
    widest : tuple of float
        How wide they are at most in each coordinate.
    """
    counts = np.ceil((high - low) / widest).astype(int)
    sides = [np.linspace(a, b, n + 1) for a, b, n in zip(low, high, counts, strict=True)]
    edges = ([side[:-1] for side in sides], [side[1:] for side in sides])
    grids = (np.meshgrid(*ends, indexing="ij") for ends in edges)
    return Boxes(*(np.stack([part.ravel() for part in grid]) for grid in grids))


def joined(parts: Sequence[Boxes]) -> Boxes:
    """Return all boxes of some."""
    return Boxes(np.hstack([part.low for part in parts]), np.hstack([part.high for part in parts]))


# For some boxes: a number that is not exceeded in each, and the coordinate to halve it across.
Bound = Callable[[Boxes], tuple[Floats, Floats]]


@dataclass(frozen=True)
class Cover:
    """Boxes that make up the whole, each with what is not exceeded in it."""

    boxes: Boxes  # Without gaps
    bounds: Floats  # Shape (n,). One number for each; not finite where nothing is known.
    goal: float  # What was to be shown of all

    @property
    def bound(self) -> float:
        """What is not exceeded anywhere."""
        return float(np.max(np.where(np.isnan(self.bounds), np.inf, self.bounds)))

    @property
    def reached(self) -> bool:
        """Whether the goal is shown."""
        return self.bound <= self.goal


def cover(
    whole: Boxes,
    bound: Bound,
    goal: float,
    allowance: Allowance | None = None,
    work: Callable[[int], float] = lambda count: 0.0,
    progress: Callable[[int, int], None] = lambda done, left: None,
) -> Cover:
    """Halve boxes until none may exceed a goal, or the allowed work does not suffice for the next.

    Parameters
    ----------
    whole : Boxes
        What is to be covered.
    bound : callable
        What is not exceeded in each of some boxes.
    goal : float
        To be shown.
    allowance : Allowance, optional
        Work; unlimited by default.
    work : callable
        What a batch of so many boxes takes of it.
    progress : callable
        Told how many boxes are done and how many are known to be left, after each batch.

    Raises
    ------
    ClockError
        If the clock stopped it.
    """
    allowance = allowance or Allowance()
    done: list[tuple[Boxes, Floats]] = []
    left, count = whole, 0
    while left.count:
        batches = [left.part(slice(k, k + BATCH)) for k in range(0, left.count, BATCH)]
        if not allowance.affords(Cost(sum(work(boxes.count) for boxes in batches))):
            break
        halves, waiting = list[Boxes](), left.count
        for boxes in batches:
            allowance.charge(work(boxes.count))
            bounds, axis = bound(boxes)
            below = bounds <= goal
            done.append((boxes.part(below), bounds[below]))
            halves.append(boxes.part(~below).halved(axis[~below]))
            count += int(below.sum())
            waiting -= boxes.count
            progress(count, waiting + sum(part.count for part in halves))
        left = joined(halves)
    done.append((left, np.full(left.count, np.inf)))
    boxes = joined([part for part, _ in done])
    return Cover(boxes, np.concatenate([values for _, values in done]), goal)
