"""Impedance cost and its global optimum (thesis 6.3.1, 6.3.2 and 6.4)."""

import math
from dataclasses import replace

import control
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from nrs_design.design.impedance_optimum import (
    ImpedanceLoop,
    ImpedanceProblem,
    impedance_cost,
    optimize_impedance,
    stabilizes,
)
from nrs_design.design.transfer import frequency_response
from nrs_design.errors import DesignError
from nrs_design.models.contact import Elastic, KelvinBoltzmann, KelvinVoigt, Maxwell
from tests.design.classical import (
    closed_loop_polynomial,
    displayed_impedance_at,
    open_loop,
    sensitivity,
)
from tests.design.motion_loops import EXACT, PRINTED, SOFT

# Thesis 6.2: 0.3 N m over 8 deg/s; 2 Hz.
DESIRED = 0.3 / math.radians(8)
BANDWIDTH = 4 * math.pi
STIFF = 61.6608

# Thesis 6.3.1 (free), 6.3.2 (soft and half) and 6.4 (stiff).
PUBLISHED = {
    "free": (SOFT, DESIRED, 0.0, 0.0, 2.1514),
    "soft": (SOFT, DESIRED, 0.01, 0.01, 2.1496),
    "half": (SOFT, DESIRED / 2, 0.01, 0.01, 1.0414),
    "stiff": (STIFF, DESIRED, 0.01, 0.01, 2.1094),
}


def make_problem(stiffness=SOFT, desired=DESIRED, least=0.0, motion=PRINTED, **changes):
    problem = ImpedanceProblem(
        loop=ImpedanceLoop(motion, Elastic(stiffness)),
        desired=desired,
        bandwidth=BANDWIDTH,
        mass_bounds=(least, 1.0),
        damping_bounds=(0.1, 20.0),
    )
    return replace(problem, **changes)


def reference_cost(problem, Mt, Bt, nodes):
    """Thesis 6.4-6.7 term by term, with the midpoint rule."""
    omega = (np.arange(nodes) + 0.5) * problem.bandwidth / nodes
    displayed = np.abs(displayed_impedance_at(problem.loop, Mt, Bt, omega))
    robust = np.abs(sensitivity(problem.loop, Mt, Bt, omega))
    first = np.mean(np.abs(math.log10(problem.desired) - np.log10(displayed)))
    return problem.weight_displayed * first + problem.weight_sensitivity * np.mean(robust)


@pytest.mark.parametrize("motion", [PRINTED, EXACT], ids=["printed", "exact"])
@pytest.mark.parametrize("name", PUBLISHED)
def test_published_optimum(name, motion):
    stiffness, desired, least, Mt, Bt = PUBLISHED[name]
    optimum = optimize_impedance(make_problem(stiffness, desired, least, motion))
    assert optimum.Mt == Mt  # exactly the bound
    assert optimum.Bt == pytest.approx(Bt, abs=2e-3)


@pytest.mark.parametrize("name", PUBLISHED)
def test_cost_does_not_depend_on_the_grid(name):
    stiffness, desired, least, Mt, Bt = PUBLISHED[name]
    problem = make_problem(stiffness, desired, least)
    fine = reference_cost(problem, Mt, Bt, 65536)
    errors = [abs(reference_cost(problem, Mt, Bt, n) - fine) for n in (16, 256)]
    assert float(impedance_cost(problem, Mt, Bt)) == pytest.approx(fine, rel=1e-5)
    assert errors[1] < errors[0] / 8


@pytest.mark.parametrize("Bt", [0.5, 1.0414, 2.15, 15.0])
def test_cost_is_the_formula_of_the_thesis(Bt):
    problem = make_problem(weight_displayed=0.3, weight_sensitivity=1.7)
    assert float(impedance_cost(problem, 0.02, Bt)) == pytest.approx(
        reference_cost(problem, 0.02, Bt, 256), rel=1e-12
    )


@settings(max_examples=25, deadline=None)
@given(
    stiffness=st.floats(5, 300),
    damping=st.sampled_from([0.0, 0.5]),
    desired=st.floats(0.3, 8),
    least=st.sampled_from([0.0, 0.01, 0.1]),
    weight=st.floats(0, 1),
)
def test_optimum_is_stable_and_no_scanned_point_beats_it(
    stiffness, damping, desired, least, weight
):
    problem = make_problem(
        desired=desired,
        least=least,
        loop=ImpedanceLoop(EXACT, KelvinVoigt(stiffness, damping)),
        weight_displayed=weight,
        weight_sensitivity=1 - weight,
    )
    optimum = optimize_impedance(problem)
    assert bool(stabilizes(problem.loop, optimum.Mt, optimum.Bt))
    assert least <= optimum.Mt <= 1
    assert 0.1 <= optimum.Bt <= 20
    assert optimum.cost == pytest.approx(float(impedance_cost(problem, optimum.Mt, optimum.Bt)))
    Mt, Bt = np.meshgrid(
        least + (1 - least) * np.linspace(0, 1, 45) ** 3, np.geomspace(0.1, 20, 95)
    )
    stable = stabilizes(problem.loop, Mt, Bt)
    assert impedance_cost(problem, Mt[stable], Bt[stable]).min() >= optimum.cost - 2e-6


def test_fixed_parameters_are_returned_as_given():
    problem = make_problem(mass_bounds=(0.02, 0.02))
    optimum = optimize_impedance(problem)
    assert optimum.Mt == 0.02
    around = optimum.Bt * np.linspace(0.5, 2, 3001)
    assert impedance_cost(problem, 0.02, around).min() >= optimum.cost - 1e-7

    both = optimize_impedance(replace(problem, damping_bounds=(2.15, 2.15)))
    assert (both.Mt, both.Bt) == (0.02, 2.15)
    assert both.cost == float(impedance_cost(problem, 0.02, 2.15))


def test_upper_bounds_are_returned_exactly():
    # The desired impedance is far above what the bounds allow.
    optimum = optimize_impedance(
        make_problem(desired=30.0, stiffness=300.0, damping_bounds=(0.1, 0.7), weight_sensitivity=0)
    )
    assert optimum.Bt == 0.7


def test_search_is_deterministic():
    assert optimize_impedance(make_problem()) == optimize_impedance(make_problem())


def test_bounds_without_a_stable_point_are_an_error_with_a_remedy():
    # Mt = 0.01, Bt <= 1.04 is unstable above 75.9 N m/rad.
    problem = make_problem(stiffness=90.0, least=0.01, damping_bounds=(0.1, 1.04))
    with pytest.raises(DesignError, match="stable at 90 N m/rad") as caught:
        optimize_impedance(problem)
    assert "Bt" in caught.value.remedy


def test_cost_in_viscoelastic_contact_is_the_mean_of_its_parts():
    contact = KelvinBoltzmann(0.233, 0.972, 23.631)
    problem = replace(make_problem(), loop=ImpedanceLoop(EXACT, contact), desired=0.1)
    omega = np.linspace(0, BANDWIDTH, 200_001)[1:]
    shown = np.abs(displayed_impedance_at(problem.loop, 0.001, 0.09, omega))
    robust = np.abs(sensitivity(problem.loop, 0.001, 0.09, omega))
    expected = 0.5 * np.abs(np.log10(0.1 / shown)).mean() + 0.5 * robust.mean()
    assert float(impedance_cost(problem, 0.001, 0.09)) == pytest.approx(expected, abs=2e-4)


def test_cost_with_a_spring_is_the_mean_of_its_parts():
    problem = replace(make_problem(), loop=ImpedanceLoop(EXACT, KelvinVoigt(SOFT, 0.3), 0.8))
    cost = float(impedance_cost(problem, 0.01, 1.04))
    assert cost == pytest.approx(reference_cost(problem, 0.01, 1.04, 256), rel=1e-9)


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
