from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from nrs_design.proof.evidence import ParameterQuadratic
from nrs_design.proof.switching import Switching
from nrs_design.reporting.kinds.parameter_quadratic import function_at, parameter_rates
from nrs_design.search.certify import certify
from tests.simulation.systems import system


def test_function_at_a_value_of_the_parameter():
    """Both ends are divided by the largest entry of either."""
    evidence = ParameterQuadratic(((1,),), ((4,),), 0, Fraction(1))
    assert function_at(evidence, 0.5) == pytest.approx(np.array([[0.625]]))


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
