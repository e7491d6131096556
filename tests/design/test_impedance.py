"""The loop of impedance control (thesis 6.3.1 and 2.5)."""

import control
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from nrs_design.design.impedance_optimum import ImpedanceLoop, stabilizes
from nrs_design.design.transfer import frequency_response
from nrs_design.errors import DesignError
from nrs_design.models.contact import Elastic, KelvinBoltzmann, KelvinVoigt, Maxwell
from tests.design.classical import (
    closed_loop_polynomial,
    displayed_impedance_at,
    open_loop,
    sensitivity,
)
from tests.design.motion_loops import EXACT, SOFT


@pytest.mark.parametrize(
    ("contact", "Ze", "Kt"),
    [
        (KelvinVoigt(SOFT, 0.4), lambda s: SOFT / s + 0.4, 0.0),
        # Thesis 2.5 and table 2.4.
        (Maxwell(1.129, 120.233), lambda s: 120.233 / (1 + 120.233 / 1.129 * s), 0.0),
        (
            KelvinBoltzmann(0.233, 0.972, 23.631),
            lambda s: (0.18795 / s + 19.06169) / (1 + 19.61079 * s),
            0.0,
        ),
        # Thesis 2.2.6.2.
        (KelvinVoigt(SOFT, 0.3), lambda s: SOFT / s + 0.3, 0.8),
    ],
)
def test_displayed_impedance_and_sensitivity_close_the_loop(contact, Ze, Kt):
    loop = ImpedanceLoop(EXACT, contact, Kt)
    omega = np.array([0.01, 0.3, 12.0, 200.0])
    s = 1j * omega
    G, Y = frequency_response(EXACT, omega), 1 / (0.01 * s + 2.15 + Kt / s)
    L = G * Ze(s) * Y
    assert frequency_response(open_loop(loop, 0.01, 2.15), omega) == pytest.approx(L, rel=1e-4)
    assert sensitivity(loop, 0.01, 2.15, omega) == pytest.approx(1 / (1 + L), rel=1e-4)
    displayed = displayed_impedance_at(loop, 0.01, 2.15, omega)
    assert displayed == pytest.approx(L / Y / (1 + L), rel=1e-4)


def test_characteristic_polynomial_without_mass_has_one_degree_less():
    loop = ImpedanceLoop(EXACT, Elastic(SOFT))
    light = np.roots(closed_loop_polynomial(loop, 1e-9, 2.15))
    none = np.roots(closed_loop_polynomial(loop, 0.0, 2.15))
    assert len(none) == 3
    slow = np.sort_complex(light[np.abs(light) < 1e6])
    assert slow == pytest.approx(np.sort_complex(none), rel=1e-5)


@given(
    Mt=st.one_of(st.just(0.0), st.floats(1e-4, 1)),
    Bt=st.floats(0.05, 20),
    stiffness=st.floats(1, 2000),
    damping=st.one_of(st.just(0.0), st.floats(0, 3)),
)
def test_stability_agrees_with_computed_roots(Mt, Bt, stiffness, damping):
    loop = ImpedanceLoop(EXACT, KelvinVoigt(stiffness, damping))
    rightmost = np.roots(closed_loop_polynomial(loop, Mt, Bt)).real.max()
    assume(abs(rightmost) > 1e-6)
    assert bool(stabilizes(loop, Mt, Bt)) == (rightmost < 0)


def test_a_spring_where_contact_has_no_rest_position_is_refused():
    with pytest.raises(DesignError, match="no rest position"):
        ImpedanceLoop(EXACT, Maxwell(1.129, 120.233), 0.8)


def test_poles_with_a_spring_are_those_that_python_control_closes():
    """The s that Ze and Y have in common is left out: python-control keeps it, a zero more."""
    s = control.tf("s")
    G = control.tf(EXACT.numerator, EXACT.denominator)
    Ze = (0.3 * s + SOFT) / s
    Y = s / (0.01 * s**2 + 1.04 * s + 0.8)
    wanted = np.sort_complex(control.feedback(G * Ze * Y, 1).poles())
    loop = ImpedanceLoop(EXACT, KelvinVoigt(SOFT, 0.3), 0.8)
    found = np.roots(closed_loop_polynomial(loop, 0.01, 1.04))
    assert np.sort_complex([*found, 0]) == pytest.approx(wanted, rel=1e-6, abs=1e-9)
