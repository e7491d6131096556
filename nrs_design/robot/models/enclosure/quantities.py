"""What a certificate of coupled axes asks of a robot: bounds over boxes, and samples at poses."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from nrs_design.robot.models.enclosure.balls import Floats
from nrs_design.robot.models.enclosure.cover import Boxes
from nrs_design.robot.models.enclosure.jet import Jet
from nrs_design.robot.models.enclosure.links import Links, Matrix
from nrs_design.robot.models.enclosure.norms import form_norm, norm
from nrs_design.robot.models.robot import Robot

# Steps that raise ``u . F(v, v)``, by the best v for a u and the best u for a v in turn.
ASCENTS = 8


class AbstractQuantity(ABC):
    """A number of a robot at a pose, of which the largest over a workspace is wanted."""

    name: ClassVar[str]
    unit: ClassVar[str]
    # Of the derivatives that the enclosure uses: more cost more, and let boxes be larger.
    order: ClassVar[int] = 1
    # How wide a box is at most at the first look: larger ones show nothing.
    widest: ClassVar[tuple[float, float, float]] = (0.041, 0.04, 0.011)
    # Work of enclosing a batch of boxes, and of each of them.
    per_batch: ClassVar[float] = 0.15
    per_box: ClassVar[float] = 1.5e-4

    def work(self, boxes: int) -> float:
        """Return the work of enclosing a batch of so many boxes, in units."""
        return self.per_batch + self.per_box * boxes

    @abstractmethod
    def forms(self, links: Links) -> list[Matrix]:
        """Return the symmetric matrices that it is a norm of."""

    def size(self, forms: Sequence[Matrix], enough: float) -> Floats:
        """Return what the number does not exceed.

        Parameters
        ----------
        forms : sequence of matrices
            Of `forms`.
        enough : float
            Where a coarser bound is not above this, it will do.
        """
        (form,) = forms
        return norm([[entry.value for entry in row] for row in form])

    def sampled(self, forms: Floats) -> Floats:
        """Return the number for matrices in floating point, shape (..., k, 3, 3)."""
        return np.asarray(np.abs(np.linalg.eigvalsh(forms[..., 0, :, :])).max(axis=-1))

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
            size = np.broadcast_to(self.size(forms, enough), (boxes.count,))
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


@dataclass(frozen=True)
class Inertia(AbstractQuantity):
    """The largest eigenvalue of M."""

    name = "inertia"
    unit = "kg*m^2"

    def forms(self, links: Links) -> list[Matrix]:
        """Return M."""
        return [links.inertia()]


@dataclass(frozen=True)
class Mobility(AbstractQuantity):
    """One over the smallest eigenvalue of M."""

    name = "mobility"
    unit = "1/(kg*m^2)"

    def forms(self, links: Links) -> list[Matrix]:
        """Return the inverse of M."""
        return [links.mobility()]


@dataclass(frozen=True)
class VelocityTorques(AbstractQuantity):
    """Coriolis and centrifugal torques over the square of the speed."""

    name = "velocity torques"
    unit = "N*m*s^2/rad^2"
    order = 2
    widest = (0.0205, 0.02, 0.0055)
    per_batch = 1.3
    per_box = 9e-4

    def forms(self, links: Links) -> list[Matrix]:
        """Return the matrix of the quadratic form of each torque."""
        return links.velocity_torques()

    def size(self, forms: Sequence[Matrix], enough: float) -> Floats:
        """Return what the norm of the torques at unit speed does not exceed."""
        return form_norm([[[e.value for e in row] for row in F] for F in forms], enough)

    def sampled(self, forms: Floats) -> Floats:
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


@dataclass(frozen=True)
class GravityGradient(AbstractQuantity):
    """The norm of the derivative of the torques of gravity."""

    name = "gravity gradient"
    unit = "N*m/rad"

    def forms(self, links: Links) -> list[Matrix]:
        """Return the derivative with respect to the joints, a symmetric matrix."""
        return [links.gravity_gradient()]
