"""Rigid bodies by the moments of their mass distribution, and the forces that one takes as a link.

A particle of the link is at ``(u, v, z)`` in the frame ``a, b, k`` of the turning plane of its leg,
where ``z`` is constant. The plane turns about ``a``, so the acceleration of the particle is
``(u'', v'' - alpha'' z - alpha'^2 v, alpha'' v + 2 alpha' v' - alpha'^2 z)``. Integrals of these
over the link are products of its moments: no inertia tensor has to be rotated.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from nrs_design.robot.models.vectors import Array, Scalar, Vector


@dataclass(frozen=True, slots=True)
class Body:
    """Mass and its first and second moments about the origin of the body's frame.

    The moments add up: two bodies that move as one are the sum of their moments, without a
    detour through a common center of mass.
    """

    mass: float  # In kg
    first: tuple[float, ...]  # ``integral r dm`` in kg m
    second: tuple[tuple[float, ...], ...]  # ``integral r r' dm`` in kg m^2, 3 x 3

    def plus(self, addend: Body) -> Body:
        """Return both bodies as one; their frames must coincide."""
        return _body(
            self.mass + addend.mass,
            np.add(self.first, addend.first),
            np.add(self.second, addend.second),
        )

    def transform(self, rotation: ArrayLike, origin: ArrayLike) -> Body:
        """Return the body in another frame, in which a point is ``origin + rotation r``."""
        R, p = np.asarray(rotation, dtype=float), np.asarray(origin, dtype=float)
        first = R @ self.first
        cross_moment = np.outer(p, first)
        second = R @ self.second @ R.T + cross_moment + cross_moment.T + self.mass * np.outer(p, p)
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


@dataclass(frozen=True, slots=True)
class Plane:
    """Turning rate and acceleration of the plane about ``a``, and gravity in its frame."""

    rate: Scalar
    rate_2: Scalar
    gravity: Vector


@dataclass(frozen=True, slots=True)
class Direction:
    """Direction of a link's x axis in the plane, as cosine and sine, with its rates."""

    cos: Scalar
    sin: Scalar
    rate: Scalar
    rate_2: Scalar


@dataclass(frozen=True, slots=True)
class PlanePoint:
    """Origin of a link's frame: distance v from the base axis, its rate, and accelerations."""

    v: Scalar
    v_1: Scalar
    u_2: Scalar
    v_2: Scalar


FIXED = PlanePoint(0.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class LinkForces:
    """Generalized forces on the plane's angle, on the link's angle, and at the link's origin."""

    alpha: Scalar
    angle: Scalar
    u: Scalar
    v: Scalar


def link_forces(body: Body, link: Direction, origin: PlanePoint, plane: Plane) -> LinkForces:
    """Return the forces that a link takes, in N m and N; its moments are about its origin."""
    m = body.mass
    hx, hy, hz = body.first
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = body.second
    c, s, w, w_2 = link.cos, link.sin, link.rate, link.rate_2
    a_1, a_2 = plane.rate, plane.rate_2
    g_a, g_b, g_k = plane.gravity
    square, turn = w * w, a_1 * a_1
    # Moments about the origin in the axes of the plane: u, v of the particles from there.
    hu, hv = hx * c - hy * s, hx * s + hy * c
    product = c * s
    vv = xx * s * s + 2 * xy * product + yy * c * c
    uv = (xx - yy) * product + xy * (c * c - s * s)
    uz, vz = xz * c - yz * s, xz * s + yz * c
    lever = m * origin.v + hv
    push_u, push_v = origin.u_2 - g_a, origin.v_2 - g_b
    outer = origin.v * hu + uv
    spin = origin.v * (lever + hv) + vv + zz
    return LinkForces(
        alpha=a_2 * spin
        + 2 * a_1 * (origin.v_1 * lever + w * outer)
        - (hz * push_v + w_2 * uz - square * vz)
        - g_k * lever,
        angle=hu * push_v - hv * push_u + w_2 * (xx + yy) - a_2 * uz - turn * outer,
        u=m * push_u - w_2 * hv - square * hu,
        v=m * push_v + w_2 * hu - square * hv - a_2 * hz - turn * lever,
    )


def first_moment(
    body: Body, origin: tuple[Scalar, Scalar], direction: tuple[Scalar, Scalar]
) -> Vector:
    """Return ``integral (u, v, z) dm`` of a link in the frame of its plane, in kg m.

    The origin of its frame is in m, its direction the cosine and sine of its angle.
    """
    hx, hy, hz = body.first
    cos, sin = direction
    u = body.mass * origin[0] + hx * cos - hy * sin
    v = body.mass * origin[1] + hx * sin + hy * cos
    return u, v, hz
