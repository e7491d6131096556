"""What a certificate of coupled axes asks of a robot: bounds over boxes, and samples at poses."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from nrs_design.robot.models.enclosure.balls import Balls, Floats
from nrs_design.robot.models.enclosure.cover import Boxes
from nrs_design.robot.models.enclosure.jet import Jet
from nrs_design.robot.models.enclosure.links import Links, Matrix
from nrs_design.robot.models.enclosure.norms import form_norm, norm
from nrs_design.robot.models.robot import Robot

# Steps that raise ``u . F(v, v)``, by the best v for a u and the best u for a v in turn.
ASCENTS = 8
Forms = Sequence[Sequence[Sequence[Balls]]]


def _norm(forms: Forms, enough: float) -> Floats:
    return norm(forms[0])


def _largest_eigenvalue(forms: Floats) -> Floats:
    return np.asarray(np.abs(np.linalg.eigvalsh(forms[..., 0, :, :])).max(axis=-1))


@dataclass(frozen=True)
class RobotQuantity:
    """A number of a robot at a pose, of which the largest over a workspace is wanted."""

    name: str
    unit: str
    forms: Callable[[Links], list[Matrix]]  # The symmetric matrices that it is a norm of
    # Upper bound on the norm of matrices; where a coarser one is not above a number, it will do.
    size: Callable[[Forms, float], Floats] = _norm
    # The norm of matrices in floating point, shape (..., k, 3, 3).
    sampled: Callable[[Floats], Floats] = _largest_eigenvalue
    # Of the derivatives that the enclosure uses: more cost more, and let boxes be larger.
    order: int = 1
    # How wide a box is at most at the first look: larger ones show nothing.
    widest: tuple[float, float, float] = (0.041, 0.04, 0.011)
    # Work of enclosing a batch of boxes, and of each of them.
    per_batch: float = 0.15
    per_box: float = 1.5e-4

    def work(self, boxes: int) -> float:
        """Return the work of enclosing a batch of so many boxes, in units."""
        return self.per_batch + self.per_box * boxes

    def at(self, robot: Robot, points: Floats) -> Floats:
        """Return the number at points, shape (3, n), in floating point."""
        still = np.zeros_like(points)
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            forms = self.forms(Links(robot, list(points), list(still), 0))
        rows = [[[entry.value.mid + 0 * points[0] for entry in row] for row in F] for F in forms]
        values = np.moveaxis(np.array(rows), -1, 0)
        finite = np.all(np.isfinite(values), axis=(1, 2, 3))
        known = np.where(finite[:, None, None, None], values, 0)
        return np.asarray(np.where(finite, self.sampled(known), 0))

    def over(self, robot: Robot, boxes: Boxes, enough: float) -> tuple[Floats, Floats]:
        """Return what the number does not exceed in each box, and across what to halve it.

        Parameters
        ----------
        robot : Robot
            The robot.
        boxes : Boxes
            Of poses.
        enough : float
            As for `size`.
        """
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            forms = self.forms(Links(robot, list(boxes.middle), list(boxes.half), self.order))
            size = np.broadcast_to(
                self.size([[[e.value for e in row] for row in F] for F in forms], enough),
                (boxes.count,),
            )
            axis = _steepest(boxes, [entry for F in forms for row in F for entry in row])
        return np.where(np.isnan(size), np.inf, size), axis


def _steepest(boxes: Boxes, entries: Sequence[Jet]) -> Floats:
    """Return across which coordinate entries change most, or the widest if that is not known."""
    changes = np.array(
        [
            np.broadcast_to(sum((entry.change(k) for entry in entries), 0.0), (boxes.count,))
            for k in range(3)
        ]
    )
    span = np.max(boxes.high, axis=1) - np.min(boxes.low, axis=1)
    known = np.all(np.isfinite(changes), axis=0)
    steep = np.argmax(np.where(known, changes, 0), axis=0)
    return np.asarray(np.where(known, steep, np.argmax(boxes.half / span[:, None], axis=0)))


def _ascent(forms: Floats) -> Floats:
    """Return the norm that alternating ascent finds from each unit vector u."""
    best = np.zeros(len(forms))
    for start in np.eye(3):
        u = np.broadcast_to(start, (len(forms), 3))
        for _ in range(ASCENTS):
            mixed = np.einsum("nc,ncij->nij", u, forms)
            values, vectors = np.linalg.eigh(mixed)
            largest = np.argmax(np.abs(values), axis=-1)
            v = np.take_along_axis(vectors, largest[:, None, None], axis=-1)[..., 0]
            torque = np.einsum("ncij,ni,nj->nc", forms, v, v)
            size = np.linalg.norm(torque, axis=-1)
            u = torque / np.where(size > 0, size, 1)[:, None]
        best = np.maximum(best, size)
    return best


QUANTITIES: Mapping[str, RobotQuantity] = {
    "heaviest": RobotQuantity("inertia", "kg*m^2", lambda links: [links.inertia()]),
    "lightest": RobotQuantity("mobility", "1/(kg*m^2)", lambda links: [links.mobility()]),
    # Coriolis and centrifugal torques over the square of the speed.
    "velocity_torques": RobotQuantity(
        "velocity torques",
        "N*m*s^2/rad^2",
        Links.velocity_torques,
        form_norm,
        _ascent,
        order=2,
        widest=(0.0205, 0.02, 0.0055),
        per_batch=1.3,
        per_box=9e-4,
    ),
    "gravity_gradient": RobotQuantity(
        "gravity gradient", "N*m/rad", lambda links: [links.gravity_gradient()]
    ),
}
