"""Many polynomials at once, and their values on the imaginary axis.

One polynomial a row, highest power first, all of one length. On ``s = j omega`` an even power is
real, so peaks and crossings are roots of polynomials in ``x = omega^2``: no grid of frequencies
decides anything. By hand, as NumPy takes one polynomial after the other.
"""

from __future__ import annotations

import numpy as np

from nrs_design.design.transfer import ComplexArray, FloatArray

# A leading coefficient this small beside the others counts as zero; its root is out of any band.
_NEGLIGIBLE = 1e-60
# How near to the axis a root counts as real, relative to its size: a double root comes out of
# floating point as a close complex pair.
_REAL = 1e-7


def multiply(a: FloatArray, b: FloatArray) -> FloatArray:
    """Multiply polynomials row by row."""
    product = np.zeros((len(a), a.shape[1] + b.shape[1] - 1))
    for i in range(a.shape[1]):
        product[:, i : i + b.shape[1]] += a[:, i : i + 1] * b
    return product


def ratio(numerator: FloatArray, denominator: FloatArray, omega: FloatArray) -> ComplexArray:
    """Return ``N/D`` at ``j omega``: row i at all frequencies (rad/s) of row i; NaN for NaN."""
    with np.errstate(invalid="ignore"):
        return _evaluate(numerator, omega) / _evaluate(denominator, omega)


def _evaluate(polynomials: FloatArray, omega: FloatArray) -> ComplexArray:
    s = np.asarray(1j * omega, dtype=np.complex128)
    value = np.zeros(omega.shape, dtype=np.complex128)
    for coefficient in polynomials.T:
        value = value * s + coefficient[:, None]
    return value


def stationary(numerator: FloatArray, denominator: FloatArray) -> FloatArray:
    """Return at which frequencies ``|N/D|`` is stationary; NaN fills the rows."""
    n, d = squared(numerator), squared(denominator)
    return frequencies(multiply(_derivative(n), d) - multiply(n, _derivative(d)))


def _derivative(polynomials: FloatArray) -> FloatArray:
    return polynomials[:, :-1] * np.arange(polynomials.shape[1] - 1, 0, -1)


def product_parts(a: FloatArray, b: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Split ``a(j omega) conj(b(j omega)) = R(x) + j omega I(x)``."""
    (a_even, a_odd), (b_even, b_odd) = _even_odd(a), _even_odd(b)
    odd = multiply(a_odd, b_odd)
    shifted = np.concatenate([odd, np.zeros((len(odd), 1))], axis=1)
    imaginary = multiply(a_odd, b_even) - multiply(a_even, b_odd)
    return _sum(multiply(a_even, b_even), shifted), imaginary


def _even_odd(polynomials: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Split ``p(j omega) = E(x) + j omega O(x)``."""
    ascending = polynomials[:, ::-1]
    even, odd = ascending[:, 0::2], ascending[:, 1::2]
    signs = (-1.0) ** np.arange(even.shape[1])
    return (even * signs)[:, ::-1], (odd * signs[: odd.shape[1]])[:, ::-1]


def _sum(a: FloatArray, b: FloatArray) -> FloatArray:
    width = max(a.shape[1], b.shape[1])
    total = np.zeros((len(a), width))
    total[:, width - a.shape[1] :] += a
    total[:, width - b.shape[1] :] += b
    return total


def squared(polynomials: FloatArray) -> FloatArray:
    """Return ``|p(j omega)|^2`` as polynomials in x."""
    return product_parts(polynomials, polynomials)[0]


def frequencies(polynomials: FloatArray) -> FloatArray:
    """Return the square roots of the positive roots of polynomials in x; NaN fills the rows."""
    found = all_roots(polynomials)
    real = (np.abs(found.imag) <= _REAL * np.abs(found)) & (found.real > 0)
    return np.sqrt(np.where(real, found.real, np.nan))


def all_roots(polynomials: FloatArray) -> ComplexArray:
    """Return all roots as eigenvalues of companion matrices; NaN fills the rows."""
    count, degree = len(polynomials), polynomials.shape[1] - 1
    found = np.full((count, degree), np.nan, dtype=np.complex128)
    size = np.abs(polynomials)
    known = size > _NEGLIGIBLE * size.max(axis=1, keepdims=True)
    leading = np.where(known.any(axis=1), known.argmax(axis=1), degree)
    for first in np.unique(leading[leading < degree]):
        rows = np.flatnonzero(leading == first)
        order = degree - int(first)
        companion = np.zeros((len(rows), order, order))
        companion[:, 1:, :-1] = np.eye(order - 1)
        companion[:, 0, :] = -polynomials[rows, first + 1 :] / polynomials[rows, first : first + 1]
        found[rows, :order] = np.linalg.eigvals(companion)
    return found
