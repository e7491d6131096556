"""Rigid bodies by the moments of their mass distribution."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from nrs_design.robot.models.vectors import Array


@dataclass(frozen=True, slots=True)
class Body:
    """Mass and its first and second moments about the origin of the body's frame.

    The moments add up: two bodies that move as one are the sum of their moments, without a
    detour through a common center of mass.
    """

    mass: float  # In kg
    first: tuple[float, ...]  # ``integral r dm`` in kg m
    second: tuple[tuple[float, ...], ...]  # ``integral r r' dm`` in kg m^2, 3 x 3

    def plus(self, other: Body) -> Body:
        """Return both bodies as one; their frames must coincide."""
        return _body(
            self.mass + other.mass,
            np.add(self.first, other.first),
            np.add(self.second, other.second),
        )

    def placed(self, rotation: ArrayLike, origin: ArrayLike) -> Body:
        """Return the body in another frame, in which a point is ``origin + rotation r``."""
        R, p = np.asarray(rotation, dtype=float), np.asarray(origin, dtype=float)
        first = R @ self.first
        mixed = np.outer(p, first)
        second = R @ self.second @ R.T + mixed + mixed.T + self.mass * np.outer(p, p)
        return _body(self.mass, first + self.mass * p, second)

    @property
    def center_of_mass(self) -> Array:
        """Center of mass in m; zero for a body without mass."""
        return np.asarray(self.first) / self.mass if self.mass else np.zeros(3)

    @property
    def inertia(self) -> Array:
        """Inertia tensor about the center of mass in kg m^2, 3 x 3."""
        c = self.center_of_mass
        central = np.asarray(self.second) - self.mass * np.outer(c, c)
        return np.asarray(np.trace(central) * np.eye(3) - central)


MASSLESS = Body(0.0, (0.0, 0.0, 0.0), ((0.0, 0.0, 0.0),) * 3)


def rigid_body(mass: float, center_of_mass: ArrayLike, inertia: ArrayLike) -> Body:
    """Return a body from mass in kg, center of mass in m, and inertia about it in kg m^2."""
    c, tensor = np.asarray(center_of_mass, dtype=float), np.asarray(inertia, dtype=float)
    central = np.trace(tensor) / 2 * np.eye(3) - tensor
    return _body(mass, mass * c, central + mass * np.outer(c, c))


def slender_rod(mass: float, center_of_mass: ArrayLike, length: float, axis: int) -> Body:
    """Return a thin rod along one axis (0, 1, 2) of its frame: ``m l^2/12`` across it; kg and m."""
    moments = np.full(3, mass * length**2 / 12)
    moments[axis] = 0.0
    return rigid_body(mass, center_of_mass, np.diag(moments))


def point_mass(mass: float, position: ArrayLike) -> Body:
    """Return a mass without extent."""
    return rigid_body(mass, position, np.zeros((3, 3)))


def _body(mass: float, first: Array, second: Array) -> Body:
    rows = tuple(tuple(map(float, row)) for row in second)
    return Body(float(mass), tuple(map(float, first)), rows)
