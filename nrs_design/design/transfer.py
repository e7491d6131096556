"""Rational transfer functions in s, and many polynomials at once.

By hand, as NumPy takes one polynomial after the other, and python-control (`to_control`) loads
matplotlib. One polynomial is a row, highest power first, all of one length. On ``s = j omega`` an
even power is real, so peaks and crossings are roots of polynomials in ``x = omega^2``: no grid of
frequencies decides anything.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import zip_longest
from typing import Any, TypeVar

import numpy as np
from numpy.polynomial.polynomial import polyval
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
BoolArray = NDArray[np.bool_]
Number = TypeVar("Number", float, Fraction)


@dataclass(frozen=True)
class TransferFunction:
    """A proper continuous-time transfer function."""

    # numerator, denominator: coefficients, highest power of s first.
    numerator: tuple[float, ...]
    denominator: tuple[float, ...]

    @property
    def order(self) -> int:
        """The degree of the denominator."""
        return len(self.denominator) - 1


def trim(polynomial: Sequence[float]) -> tuple[float, ...]:
    """Return the coefficients without leading zeros (at least one coefficient remains)."""
    leading = next((i for i, value in enumerate(polynomial) if value != 0), len(polynomial) - 1)
    return tuple(float(value) for value in polynomial[leading:])


def frequency_response(tf: TransferFunction, omega: ArrayLike) -> ComplexArray:
    """Evaluate a transfer function at ``s = j omega``, in the shape of omega in rad/s."""
    s = 1j * np.asarray(omega, dtype=np.float64)
    value = np.polyval(tf.numerator, s) / np.polyval(tf.denominator, s)
    return np.asarray(value, dtype=np.complex128)


def poles(tf: TransferFunction) -> ComplexArray:
    """Return the poles, rad/s, rightmost first and the upper one of a pair before the lower."""
    found = np.asarray(np.roots(tf.denominator), dtype=np.complex128)
    return found[np.lexsort((-found.imag, -found.real))]


def static_gain(tf: TransferFunction) -> float:
    """Return G(0): infinite where the function integrates."""
    if tf.denominator[-1] == 0:
        return math.inf
    return tf.numerator[-1] / tf.denominator[-1]


def to_control(tf: TransferFunction) -> Any:
    """Return the function as python-control's own ``TransferFunction``."""
    from nrs_design.control_library import control

    return control.TransferFunction(list(trim(tf.numerator)), list(tf.denominator))


def controllable_form(
    numerator: Sequence[Number], denominator: Sequence[Number]
) -> tuple[FloatArray, FloatArray]:
    """Return A and C of a strictly proper transfer function; B has a one in its last place."""
    n, leading = len(denominator) - 1, denominator[0]
    A, C = np.eye(n, k=1), np.zeros(n)
    A[-1] = [-float(c / leading) for c in reversed(denominator[1:])]
    C[: len(numerator)] = [float(c / leading) for c in reversed(numerator)]
    return A, C


def hurwitz(coefficients: ArrayLike) -> BoolArray:
    """Tell which of many polynomials, one per row, have all roots in the open left half plane.

    Routh's array for all polynomials at once, the highest power first. Leading zeros lower the
    degree, as of an admittance without mass; the zero polynomial is not Hurwitz.
    """
    table = np.asarray(coefficients, dtype=np.float64)
    rows = table.reshape(-1, table.shape[-1])
    lower = rows[:, 0] == 0
    if not lower.any():
        return _routh(rows).reshape(table.shape[:-1])
    stable = np.zeros(len(rows), dtype=np.bool_)
    stable[~lower] = _routh(rows[~lower])
    if rows.shape[1] > 1:
        stable[lower] = hurwitz(rows[lower, 1:])
    return stable.reshape(table.shape[:-1])


def _routh(rows: FloatArray) -> BoolArray:
    """Run Routh's array on rows whose first entry is not zero."""
    columns = list((rows / rows[:, :1]).T)
    numerators, denominators = columns[0::2], columns[1::2]
    stable = np.ones(len(rows), dtype=np.bool_)
    for _ in range(len(columns) - 1):
        # NaN fails this comparison: a row that overflowed must not pass for stable.
        stable &= denominators[0] > 0
        ratio = numerators[0] / np.where(stable, denominators[0], 1.0)
        pairs = zip_longest(numerators[1:], denominators[1:], fillvalue=0.0)
        numerators, denominators = denominators, [upper - ratio * lower for upper, lower in pairs]
    return stable


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
    s = 1j * omega
    with np.errstate(invalid="ignore"):
        above, below = (
            polyval(s, p.T[::-1, :, None], tensor=False) for p in (numerator, denominator)
        )
        return np.asarray(above / below, dtype=np.complex128)


def stationary(numerator: FloatArray, denominator: FloatArray) -> FloatArray:
    """Return at which frequencies ``|N/D|`` is stationary; NaN fills the rows."""
    n, d = squared(numerator), squared(denominator)
    return frequencies(multiply(_derivative(n), d) - multiply(n, _derivative(d)))


def _derivative(polynomials: FloatArray) -> FloatArray:
    return polynomials[:, :-1] * np.arange(polynomials.shape[1] - 1, 0, -1)


def product_parts(a: FloatArray, b: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Split ``a(j omega) conj(b(j omega)) = R(x) + j omega I(x)``."""
    (a_even, a_odd), (b_even, b_odd) = _even_odd(a), _even_odd(b)
    shifted = np.pad(multiply(a_odd, b_odd), ((0, 0), (0, 1)))
    imaginary = multiply(a_odd, b_even) - multiply(a_even, b_odd)
    return _sum(multiply(a_even, b_even), shifted), imaginary


def _even_odd(polynomials: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Split ``p(j omega) = E(x) + j omega O(x)``."""
    ascending = polynomials[:, ::-1]
    even_terms, odd = ascending[:, 0::2], ascending[:, 1::2]
    signs = (-1.0) ** np.arange(even_terms.shape[1])
    return (even_terms * signs)[:, ::-1], (odd * signs[: odd.shape[1]])[:, ::-1]


def _sum(a: FloatArray, b: FloatArray) -> FloatArray:
    """Add polynomials row by row."""
    width = max(a.shape[1], b.shape[1])
    a, b = (np.pad(p, ((0, 0), (width - p.shape[1], 0))) for p in (a, b))
    return np.asarray(a + b)


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
