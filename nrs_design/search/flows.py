"""What modes make of a state over many times at once: exponentials, or powers.

By hand, as `expm` of SciPy begins anew for every time; one decomposition of a mode serves them all.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.mode import Time

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]


@dataclass(frozen=True)
class Flows:
    """Exponentials of the modes, by their eigenvectors: a search needs many, not perfect ones.

    In discrete time, powers of the modes.
    """

    matrices: Array
    time: Time
    values: ComplexArray
    vectors: ComplexArray
    inverses: ComplexArray

    @classmethod
    def of(cls, matrices: Array, time: Time) -> Flows:
        """Decompose the modes; shape (m, n, n)."""
        values, vectors = np.linalg.eig(matrices.astype(complex))
        # A defective mode is moved off its defect a little; the exact check is what counts.
        if time is Time.CONTINUOUS and (np.linalg.cond(vectors) > 1e10).any():
            rng = np.random.default_rng(0)
            noise = 1e-6 * np.abs(matrices).max() * rng.standard_normal(matrices.shape)
            values, vectors = np.linalg.eig(matrices + noise)
        inverses = np.linalg.inv(vectors) if time is Time.CONTINUOUS else vectors
        return cls(matrices, time, values, vectors, inverses)

    def at(self, mode: int, times: Array) -> ComplexArray | Array:
        """Return ``exp(A t)``, or ``A^t``, for all times t; shape (..., n, n)."""
        if self.time is Time.DISCRETE:
            counts, places = np.unique(times, return_inverse=True)
            powers = [np.linalg.matrix_power(self.matrices[mode], int(k)) for k in counts]
            return np.asarray(np.array(powers)[places.reshape(np.shape(times))])
        factors = np.exp(self.values[mode] * times[..., None])
        return np.asarray((self.vectors[mode] * factors[..., None, :]) @ self.inverses[mode])


def spectral_radii(products: ComplexArray | Array) -> Array:
    """Return the spectral radius of every matrix; zero where floating point has overflowed."""
    finite = np.isfinite(products).all(axis=(-1, -2), keepdims=True)
    safe = np.where(finite, products, 0)
    return np.asarray(np.abs(np.linalg.eigvals(safe)).max(axis=-1))
