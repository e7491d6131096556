"""The standard linear solid: its two sets of coefficients."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.models.contact import Elastic, KelvinBoltzmann, KelvinVoigt, Maxwell
from tests.identification.support import wobble

positive = st.floats(1e-3, 1e3)


@given(positive, positive, positive)
def test_round_trip(k1, k2, b):
    law = KelvinBoltzmann(k1, k2, b)
    back = KelvinBoltzmann.create_from_eta(*law.eta)
    # k2 - eta1 cancels where k1 is much larger than k2.
    assert back.values == pytest.approx(law.values, rel=1e-8)


def test_printed_coefficients_without_elements():
    """Thesis 6.1, stiff specimen, second experiment."""
    with pytest.raises(ValueError, match="must be above"):
        KelvinBoltzmann.create_from_eta(1077.9, 0.0044, 5.2e-4)


def test_limits():
    """Without k1 it is a Maxwell element, with a rigid k2 Kelvin-Voigt, with neither a spring."""
    motion = wobble(1)
    maxwell = Maxwell(2.0, 3.0).simulate(motion)
    assert KelvinBoltzmann(1e-9, 2.0, 3.0).simulate(motion) == pytest.approx(maxwell, abs=1e-6)
    spring = Elastic(2.0).simulate(motion)
    assert KelvinBoltzmann(1e9, 2.0, 3.0).simulate(motion) == pytest.approx(spring, abs=1e-6)
    assert KelvinVoigt(2.0, 0.0).simulate(motion) == pytest.approx(spring)
