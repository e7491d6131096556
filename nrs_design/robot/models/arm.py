"""An open chain or tree of rigid links, as URDF and MJCF describe it, and its tip."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
MAX_JOINTS = 12


@dataclass(frozen=True, slots=True)
class ArmJoint:
    """A joint that moves, and the rigid body behind it."""

    name: str
    parent: int  # The joint before it; -1 for the base
    # From the body before to this one where the joint is at zero: rotation and place, in m.
    rotation: Floats  # Shape (3, 3)
    place: Floats  # Shape (3,)
    axis: Floats  # A unit vector in its own frame
    slides: bool  # Along the axis; else it turns about it
    limits: tuple[float, float] | None  # In rad or m; None for one that turns without end
    # Spatial inertia of the body in the frame of the joint, angular part first: shape (6, 6).
    inertia: Floats
    armature: float = 0.0  # Of its drive, at the joint, in kg m^2 or kg


@dataclass(frozen=True, slots=True)
class ArmTree:
    """All joints that move, parents first, and the frame of the tip."""

    name: str
    joints: tuple[ArmJoint, ...]
    tip: int  # The joint whose body the tip is on
    # Of the tip in the frame of that joint.
    tip_rotation: Floats
    tip_place: Floats

    @property
    def order(self) -> int:
        """How many joints move."""
        return len(self.joints)


@dataclass(frozen=True, slots=True)
class ArmMobility:
    """What is found and shown of the mobility of an arm."""

    arm: str
    model: Path  # URDF or MJCF
    axes: tuple[str, ...]  # Of the tip
    joints: tuple[str, ...]
    # Lowest and highest: as a spec declares them, and as poses have them, in floating point.
    declared: tuple[float, float]
    found: tuple[float, float]
    # The joint positions of what is found, in rad and m, and in words.
    at: tuple[tuple[float, ...], tuple[float, ...]]
    where: tuple[str, str]
    faults: tuple[str, ...]  # Where a pose is beyond what is declared
    shown: bool  # Whether what is declared holds in all poses that are used

    @property
    def verdict(self) -> str:
        """Whether it is proved, refuted or neither."""
        return "refuted" if self.faults else "proved" if self.shown else "inconclusive"


def spatial_inertia(mass: float, center: Floats, tensor: Floats) -> Floats:
    """Return the spatial inertia of a body, angular part first (Featherstone 2008, 2.63).

    Parameters
    ----------
    mass : float
        In kg.
    center : array, shape (3,)
        Of mass, in m.
    tensor : array, shape (3, 3)
        About the center of mass, in kg m^2.
    """
    c = cross_matrix(center)
    return np.block([[tensor + mass * c @ c.T, mass * c], [mass * c.T, mass * np.eye(3)]])


def motion_transform(rotation: Floats, place: Floats) -> Floats:
    """Return what turns spatial velocities of a frame into those of another that is fixed to it.

    Parameters
    ----------
    rotation : array, shape (..., 3, 3)
        Of the other frame in the first: its columns are the axes.
    place : array, shape (3,)
        Of its origin, in the first.
    """
    rotated = np.swapaxes(rotation, -1, -2)
    zero = np.zeros_like(rotated)
    return np.block([[rotated, zero], [-rotated @ cross_matrix(place), rotated]])


def cross_matrix(v: Floats) -> Floats:
    """Return the matrix of the cross product with a vector."""
    x, y, z = v
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def cross_motion(S: Floats) -> Floats:
    """Return the matrix of the cross product of spatial velocities with one."""
    w, v = cross_matrix(S[:3]), cross_matrix(S[3:])
    return np.block([[w, np.zeros((3, 3))], [v, w]])


def turned(axis: Floats, angle: float) -> Floats:
    """Return the rotation about a unit vector (Rodrigues)."""
    a = cross_matrix(axis)
    return np.asarray(np.eye(3) + np.sin(angle) * a + (1 - np.cos(angle)) * (a @ a))


def joint_axis(joint: ArmJoint) -> Floats:
    """Return the spatial velocity of a body while its joint moves at the speed 1."""
    zero = np.zeros(3)
    return np.concatenate([zero, joint.axis] if joint.slides else [joint.axis, zero])


def jacobian_and_mass(arm: ArmTree, q: Floats) -> tuple[Floats, Floats]:
    """Return the Jacobian of the tip in its own frame, linear part first, and the mass matrix.

    Parameters
    ----------
    arm : ArmTree
        The arm.
    q : array, shape (..., n)
        Joint positions, in rad or m.

    Returns
    -------
    array, shape (..., 6, n)
        In m/s and rad/s per joint speed.
    array, shape (..., n, n)
        In kg m^2, kg m and kg.
    """
    n, shape = arm.order, q.shape[:-1]
    found: list[Floats] = []
    M = np.zeros((*shape, n, n))
    for i, joint in enumerate(arm.joints):
        before = found[joint.parent] if joint.parent >= 0 else np.zeros((*shape, 6, n))
        J = _joint_motion(joint, q[..., i]) @ before
        J[..., i] += joint_axis(joint)
        found.append(J)
        M += np.swapaxes(J, -1, -2) @ joint.inertia @ J
        M[..., i, i] += joint.armature
    tip = motion_transform(arm.tip_rotation, arm.tip_place) @ found[arm.tip]
    return np.concatenate([tip[..., 3:, :], tip[..., :3, :]], axis=-2), M


def mobility(arm: ArmTree, q: Floats, inertias: Floats, axes: list[int]) -> Floats:
    """Return ``J^(1/2) Lambda(q)^-1 J^(1/2)`` in some directions of the tip, in floating point.

    Parameters
    ----------
    arm : ArmTree
        The arm.
    q : array, shape (..., n)
        Joint positions, in rad or m.
    inertias : array, shape (k,)
        The J of the axes, in kg or kg m^2.
    axes : list of int
        Which rows of the Jacobian: 0 to 2 are x, y, z, 3 to 5 the rotations about them.

    Returns
    -------
    array, shape (..., k, k)
    """
    J, M = jacobian_and_mass(arm, q)
    J = J[..., axes, :]
    root = np.sqrt(inertias)
    inverse = J @ np.linalg.solve(M, np.swapaxes(J, -1, -2))
    return np.asarray(root[:, None] * inverse * root)


def _joint_motion(joint: ArmJoint, q: Floats) -> Floats:
    """Return the motion transform from the body before to that of a joint."""
    fixed = motion_transform(joint.rotation, joint.place)
    E = np.eye(3)
    a = cross_matrix(joint.axis)
    if joint.slides:
        moved = np.zeros((*q.shape, 6, 6))
        moved[..., :3, :3] = moved[..., 3:, 3:] = E
        moved[..., 3:, :3] = -q[..., None, None] * a
        return moved @ fixed
    cos, sin = np.cos(q)[..., None, None], np.sin(q)[..., None, None]
    # Rodrigues' formula for the transposed rotation.
    rotated = E - sin * a + (1 - cos) * (a @ a)
    zero = np.zeros_like(rotated)
    return (
        np.concatenate(
            [np.concatenate([rotated, zero], axis=-1), np.concatenate([zero, rotated], axis=-1)],
            axis=-2,
        )
        @ fixed
    )
