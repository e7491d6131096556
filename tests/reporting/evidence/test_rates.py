from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from nrs_design.proof.mode import Time
from nrs_design.reporting.evidence.offers import Form, offer_of
from nrs_design.reporting.evidence.rates import sampled_rates
from nrs_design.search.certify import certify
from nrs_design.search.method import Method
from nrs_design.simulation.rates import mode_rates
from tests.proof.graphs import shape_of
from tests.simulation.systems import system

# Narendra and Balakrishnan (1994), commuting modes.
COMMUTING = system([[-1, 1], [-1, -1]], [[-2, 3], [-3, -2]])


def test_polynomial_rates_lie_between_the_claim_and_the_mode():
    found = certify(COMMUTING, Method.POLYNOMIAL)
    assert shape_of(found.evidence) == "common-polynomial"
    rates = sampled_rates(COMMUTING, offer_of(found.evidence).forms[0])
    assert (rates >= float(found.evidence.rate)).all()
    # No function shows more than the mode's own rate; directions are sampled.
    assert (rates <= np.array([1.0, 2.0]) + 1e-3).all()


def test_polynomial_rates_in_discrete_time():
    # Rotations that shrink by a half and by a quarter.
    discrete = system([[0, "1/2"], ["-1/2", 0]], [[0, "1/4"], ["-1/4", 0]], time=Time.DISCRETE)
    found = certify(discrete, Method.POLYNOMIAL)
    assert shape_of(found.evidence) == "common-polynomial"
    rates = sampled_rates(discrete, offer_of(found.evidence).forms[0])
    assert (rates <= float(found.evidence.rate)).all()
    assert (rates >= np.array([0.5, 0.25]) - 1e-3).all()


@pytest.mark.parametrize("time", Time)
def test_sampled_rates_are_nearly_those_of_the_eigenvalues_and_no_slower(time):
    half = Fraction(-1, 2)
    family = system([[half, 1], [0, half]], [[half, 0], [0, Fraction(-1, 3)]], time=time)
    Q = ((3, 1), (1, 2))
    expected, sampled = mode_rates(family, np.array(Q, float)), sampled_rates(family, Form(Q))
    assert sampled == pytest.approx(expected, rel=0.05, abs=0.01)
    faster = sampled - expected if time is Time.CONTINUOUS else expected - sampled
    assert (faster >= -1e-9).all()
