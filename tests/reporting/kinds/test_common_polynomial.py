from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.proof.evidence import CommonPolynomial
from nrs_design.proof.mode import Time
from nrs_design.reporting.kinds.common_polynomial import polynomial_rates
from nrs_design.search.certify import certify
from nrs_design.search.method import Method
from nrs_design.simulation.rates import mode_rates
from tests.simulation.systems import system

# Narendra and Balakrishnan (1994), commuting modes.
COMMUTING = system([[-1, 1], [-1, -1]], [[-2, 3], [-3, -2]])


def test_polynomial_rates_lie_between_the_claim_and_the_mode():
    found = certify(COMMUTING, Method.POLYNOMIAL)
    assert isinstance(found.evidence, CommonPolynomial)
    rates = polynomial_rates(COMMUTING, found.evidence)
    assert (rates >= float(found.evidence.rate)).all()
    # No function shows more than the mode's own rate.
    assert (rates <= np.array([1.0, 2.0]) + 1e-9).all()


def test_polynomial_rates_in_discrete_time():
    # Rotations that shrink by a half and by a quarter.
    discrete = system([[0, "1/2"], ["-1/2", 0]], [[0, "1/4"], ["-1/4", 0]], time=Time.DISCRETE)
    found = certify(discrete, Method.POLYNOMIAL)
    assert isinstance(found.evidence, CommonPolynomial)
    rates = polynomial_rates(discrete, found.evidence)
    assert (rates <= float(found.evidence.rate)).all()
    assert (rates >= np.array([0.5, 0.25]) - 1e-9).all()


@pytest.mark.parametrize("time", Time)
@given(n=st.integers(1, 60), q=st.integers(1, 60), rate=st.fractions("1/64", "1/4"))
def test_quadratic_written_as_a_polynomial_has_the_rates_of_the_quadratic(time, n, q, rate):
    """Whatever denominators the modes and the claimed rate have."""
    family = system([[Fraction(-n, q), 1], [0, Fraction(-q, n)]], [[-2, 0], [0, -3]], time=time)
    Q, zero = ((3, 1), (1, 2)), ((0, 0), (0, 0))
    polynomial = CommonPolynomial(1, Q, 0, (zero, zero), rate)
    expected = mode_rates(family, np.array(Q, dtype=float))
    assert polynomial_rates(family, polynomial) == pytest.approx(expected, rel=1e-6, abs=1e-6)
