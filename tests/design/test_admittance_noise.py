"""White noise in the force of a sampled admittance: closed form against the sum of its answers."""

from fractions import Fraction

import numpy as np
import pytest

from nrs_design.controllers.laws import Admittance
from nrs_design.design.admittance_noise import noise_gain


@pytest.mark.parametrize("method", ["exact", "euler"])
@pytest.mark.parametrize(("Mt", "Bt"), [(0.01, 2.15), (0.01, 1.04), (0.3, 5.0), (0.0, 2.15)])
def test_the_sum_of_the_answers_to_one_sample(Mt, Bt, method):
    law = Admittance(Fraction(Mt), Fraction(Bt))
    numbers = law.discretize(Fraction(2, 1000), method).numbers
    a, b = float(numbers.get("a", 0)), float(numbers["b"])
    answers = b * a ** np.arange(100_000)
    found = noise_gain(Mt, Bt, 0.002, method)
    assert found == pytest.approx(np.sqrt((answers**2).sum()), rel=1e-5)


def test_shares_of_the_mass():
    """Mt = 0.01 makes 0.46 and 0.32 of the noise that Mt = 0 makes."""
    for Bt, share in ((2.15, 0.46), (1.04, 0.32)):
        with_mass, without = (noise_gain(Mt, Bt, 0.002, "exact") for Mt in (0.01, 0.0))
        assert with_mass / without == pytest.approx(share, abs=5e-3)


def test_a_step_of_euler_that_grows():
    assert noise_gain(0.001, 2.15, 0.002, "euler") == float("inf")
