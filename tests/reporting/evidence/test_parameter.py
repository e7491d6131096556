from __future__ import annotations

import numpy as np

from nrs_design.proof.evidence import ParameterQuadratic
from nrs_design.proof.switching import Switching
from nrs_design.reporting.evidence.parameter import parameter_rates
from nrs_design.search.certify import certify
from nrs_design.simulation.norms import scaled_matrices
from tests.simulation.systems import system


def test_parameter_rates_at_the_ends_are_those_of_the_modes():
    ends = Switching(transitions=(), fixed_ends=(("m0", "m1"),))
    family = system([[0, 1], [-2, -1]], [[0, 1], [-32, -1]], switching=ends)
    found = certify(family)
    assert isinstance(found.evidence, ParameterQuadratic)
    ends = scaled_matrices(found.evidence.low, found.evidence.high)
    names, rates = parameter_rates(family, ends, np.linspace(0, 1, 5))
    assert names == ["m0 to m1"]
    assert (rates > float(found.evidence.rate)).all()
    # The trace of every mode is -1, so that no norm decays faster than at half of it.
    assert (rates <= 0.5 + 1e-9).all()
