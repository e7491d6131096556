from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.certificates.certify import Method, certify
from nrs_design.certificates.evidence import CommonPolynomial, ParameterQuadratic
from nrs_design.simulation.margins import mode_rates, parameter_rates, polynomial_rates
from nrs_design.switched.system import Switching, Time
from tests.simulation.systems import system

# Narendra and Balakrishnan (1994), commuting modes.
COMMUTING = system([[-1, 1], [-1, -1]], [[-2, 3], [-3, -2]])


def test_mode_rates_of_rotations_are_their_real_parts():
    assert mode_rates(COMMUTING, np.eye(2)) == pytest.approx([1.0, 2.0])


def test_mode_rates_in_discrete_time_are_singular_values():
    discrete = system([[0, 2], [0, 0]], [[0, 0], [0, 0]], time=Time.DISCRETE)
    assert mode_rates(discrete, np.eye(2)) == pytest.approx([2.0, 0.0])


@given(st.floats(1e-6, 1e6))
def test_mode_rates_do_not_depend_on_the_scale_of_Q(factor):
    Q = np.array([[2.0, 0.5], [0.5, 1.0]])
    assert mode_rates(COMMUTING, factor * Q) == pytest.approx(mode_rates(COMMUTING, Q))


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


def test_parameter_rates_at_the_ends_are_those_of_the_modes():
    ends = Switching(transitions=(), fixed_ends=(("m0", "m1"),))
    family = system([[0, 1], [-2, -1]], [[0, 1], [-32, -1]], switching=ends)
    found = certify(family)
    assert isinstance(found.evidence, ParameterQuadratic)
    names, rates = parameter_rates(family, found.evidence, np.linspace(0, 1, 5))
    assert names == ["m0 to m1"]
    assert (rates > float(found.evidence.rate)).all()
    # The trace of every mode is -1, so that no norm decays faster than at half of it.
    assert (rates <= 0.5 + 1e-9).all()
