"""Vectors as three arrays, so that one operation serves every pose of a batch at once."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]
Scalar: TypeAlias = Any  # float, or an array over the batch
Vector: TypeAlias = tuple[Scalar, Scalar, Scalar]


def dot(a: Vector, b: Vector) -> Scalar:
    """Inner product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    """Vector product."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def scale(factor: Scalar, a: Vector) -> Vector:
    """Multiply a vector by a number."""
    return (factor * a[0], factor * a[1], factor * a[2])


def add(a: Vector, b: Vector) -> Vector:
    """Sum of two vectors."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def components(rows: Any) -> Vector:
    """Split an array of shape (..., 3) into its three components."""
    array = np.asarray(rows)
    if array.shape[-1:] != (3,):
        raise ValueError(f"expected an array of shape (..., 3), got {array.shape}")
    return array[..., 0], array[..., 1], array[..., 2]


def root_mean_square(error: Array) -> Array:
    """Return the root mean square over the first axis."""
    return np.asarray(np.sqrt(np.mean(error**2, axis=0)), dtype=np.float64)


def stack(vector: Vector) -> Any:
    """Join three components to an array of shape (..., 3)."""
    return np.stack(np.broadcast_arrays(*vector), axis=-1)
