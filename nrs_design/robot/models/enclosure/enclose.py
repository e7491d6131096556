"""Bounds on what the links of a robot do to its axes, over all poses of a workspace."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import inf, sin

import numpy as np
from numpy.typing import ArrayLike

from nrs_design.progress import Progress, silent
from nrs_design.robot.models.enclosure.balls import Floats
from nrs_design.robot.models.enclosure.cover import Boxes, Cover, cover, cut
from nrs_design.robot.models.enclosure.quantities import RobotQuantity
from nrs_design.robot.models.robot import Robot, Workspace
from nrs_design.work import Allowance, Fuse

# A sine and a number of a spec are off by a few units of the last place at most.
OUTSIDE = 2.0**-45
# Values of each coordinate at which the first look is taken, and how the looks after it close in.
GRID = (21, 21, 9)
CLOSER_GRID = (9, 9, 9)
ZOOMS = 6
CLOSER = 0.3
# Relative distance below which two values are one: rounding is far below it.
TIE = 1e-10
# Which bound will do, given the largest value that was found.
Goal = Callable[[float], float]


@dataclass(frozen=True)
class Enclosed:
    """The largest value of a quantity over a workspace, from both sides."""

    quantity: RobotQuantity  # Of what
    found: float  # At a pose, in floating point; not above the largest value but for rounding
    pose: tuple[float, float, float]  # That pose, (phi, psi, d) in rad and m
    cover: Cover  # The boxes that show the bound

    @property
    def bound(self) -> float:
        """What is not exceeded anywhere; not finite where that was not shown."""
        return self.cover.bound


def box_of(workspace: Workspace) -> tuple[Floats, Floats]:
    """Return the lowest and the highest x, y and d of a workspace, rounded outwards."""
    x, y = (sin(angle) * (1 + OUTSIDE) for angle in (workspace.psi, workspace.phi))
    shallow, deep = workspace.d
    low = np.array([-x, -y, shallow * (1 - OUTSIDE)])
    return low, np.array([x, y, deep * (1 + OUTSIDE)])


def to_pose(point: Floats) -> tuple[float, float, float]:
    """Return (phi, psi, d) of a point (x, y, d)."""
    x, y, d = (float(part) for part in point)
    return float(np.arcsin(-y)), float(np.arcsin(x)), d


def values_at(robot: Robot, quantity: RobotQuantity, pose: ArrayLike) -> Floats:
    """Return a quantity at poses, in floating point.

    Parameters
    ----------
    robot : Robot
        The robot.
    quantity : RobotQuantity
        Which.
    pose : array_like
        (phi, psi, d), shape (..., 3), in rad and m.
    """
    phi, psi, d = np.moveaxis(np.asarray(pose, dtype=np.float64), -1, 0)
    points = np.stack([np.sin(psi).ravel(), -np.sin(phi).ravel(), d.ravel()])
    return quantity.at(robot, points).reshape(d.shape)


def find_largest(
    robot: Robot, quantity: RobotQuantity, workspace: Workspace
) -> tuple[float, tuple[float, float, float]]:
    """Sample a quantity over a workspace, ever closer to the largest value so far.

    Parameters
    ----------
    robot : Robot
        The robot.
    quantity : RobotQuantity
        Of which the largest value is wanted.
    workspace : Workspace
        All of it must be reachable.

    Returns
    -------
    float
        The largest value found.
    tuple of float
        Its pose.
    """
    low, high = box_of(workspace)
    center, span = (low + high) / 2, high - low
    best, where = -inf, center
    for zoom in range(ZOOMS):
        around = CLOSER**zoom * span / 2
        grid = CLOSER_GRID if zoom else GRID
        ends = np.clip(where - around, low, high), np.clip(where + around, low, high)
        sides = [np.linspace(a, b, n) for a, b, n in zip(*ends, grid, strict=True)]
        points = np.stack([axis.ravel() for axis in np.meshgrid(*sides, indexing="ij")])
        values = quantity.at(robot, points)
        # Poses that mirror each other are equal but for rounding, which differs between machines
        # and runs: the first of them is taken.
        k = int(np.argmax(values >= values.max() * (1 - TIE)))
        if values[k] > best * (1 + TIE):
            best, where = float(values[k]), points[:, k]
    return float(f"{best:.9g}"), to_pose(where)


def enclose(
    robot: Robot,
    quantity: RobotQuantity,
    workspace: Workspace,
    goal: Goal,
    budget: float = inf,
    progress: Progress = silent,
) -> Enclosed:
    """Show a bound on a quantity over a workspace.

    Parameters
    ----------
    robot : Robot
        The robot.
    quantity : RobotQuantity
        Of which the largest value is wanted.
    workspace : Workspace
        Over which.
    goal : callable
        Which bound will do, given the largest value that was found.
    budget : float
        Work, in units.
    progress : callable
        Told what is being done.
    """
    progress(f"{quantity.name}: looking for the largest value")
    found, pose = find_largest(robot, quantity, workspace)
    wanted = goal(found)
    # What a pose exceeds is not shown of boxes either, however long they are halved.
    allowance = Allowance(budget if found <= wanted else 0.0, fuse=Fuse.of(budget))

    def bound(boxes: Boxes) -> tuple[Floats, Floats]:
        return quantity.over(robot, boxes, wanted)

    def told(done: int, left: int) -> None:
        progress(f"{quantity.name}: {done} boxes shown, {left} left")

    return Enclosed(
        quantity,
        found,
        pose,
        cover(
            cut(*box_of(workspace), quantity.widest), bound, wanted, allowance, quantity.work, told
        ),
    )
