"""Polynomials on the imaginary axis, held against complex arithmetic."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.design.polynomials import (
    frequencies,
    multiply,
    product_parts,
    ratio,
    squared,
    stationary,
)

coefficients = st.lists(st.floats(-5, 5).map(lambda x: round(x, 3)), min_size=4, max_size=4)


@given(coefficients, coefficients, st.floats(0, 2))
def test_parts_agree_with_complex_arithmetic(a, b, omega):
    real, imaginary = product_parts(np.array([a]), np.array([b]))
    at_a, at_b = np.polyval(a, 1j * omega), np.polyval(b, 1j * omega)
    x = omega**2
    found = np.polyval(real[0], x) + 1j * omega * np.polyval(imaginary[0], x)
    assert found == pytest.approx(at_a * np.conj(at_b), abs=1e-7)
    assert np.polyval(squared(np.array([a]))[0], x) == pytest.approx(abs(at_a) ** 2, abs=1e-7)
    assert np.polyval(multiply(np.array([a]), np.array([b]))[0], omega) == pytest.approx(
        np.polyval(a, omega) * np.polyval(b, omega), abs=1e-7
    )


def test_a_resonance_is_stationary_at_its_peak():
    """``|1/(s^2 + 2 zeta s + 1)|`` peaks at ``sqrt(1 - 2 zeta^2)``."""
    zeta = 0.3
    one, resonance = np.array([[0.0, 0.0, 1.0]]), np.array([[1.0, 2 * zeta, 1.0]])
    omega = stationary(one, resonance)
    assert np.nanmax(omega) == pytest.approx(np.sqrt(1 - 2 * zeta**2))
    peak = np.abs(ratio(one, resonance, omega))
    assert np.nanmax(peak) == pytest.approx(1 / (2 * zeta * np.sqrt(1 - zeta**2)))


def test_frequencies_leave_out_other_roots_and_mix_degrees():
    rows = np.array([np.poly([4, 9, -1]), [0, *np.poly([1 - 1j, 1 + 1j]).real], [0, 0, 0, 1.0]])
    found = [sorted(row[~np.isnan(row)]) for row in frequencies(rows)]
    assert found == [pytest.approx([2, 3]), [], []]
