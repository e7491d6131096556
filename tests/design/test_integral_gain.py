"""The gains of a PI force controller, and what they achieve."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import expm

from nrs_design.design.analysis import analyze_design, design_controllers
from nrs_design.design.force_loop import Approach, peak_force
from nrs_design.design.laws.pi_force import add_integral, integral_gain
from nrs_design.errors import DesignError
from nrs_design.spec import parse_spec
from nrs_design.spec.build_plant import build_plant
from tests.design.motion_loops import GAIN, LOOP, TAU
from tests.simulation.interactions import POSITION, text_of

SOFT, FD = 43.0356, 0.3


def poles_of(stiffness, Kp, Ki):
    """Roots of ``s D + k (Kp s + Ki) N``."""
    forward = stiffness * np.polymul([Kp, Ki], LOOP.numerator)
    return np.roots(np.polyadd([*LOOP.denominator, 0.0], forward))


@settings(max_examples=25)
@given(k=st.floats(10, 90), Kp=st.floats(0.005, 0.05), settling=st.floats(0.25, 5))
def test_the_slowest_pole_is_where_it_was_asked_for(k, Kp, settling):
    Ki = integral_gain(LOOP, k, Kp, settling)
    assert max(poles_of(k, Kp, Ki).real) == pytest.approx(-4 / settling, rel=1e-6)


@pytest.mark.parametrize("settling", [0.05, 0.1])
def test_what_is_too_fast_is_refused(settling):
    with pytest.raises(DesignError, match="another pole is slower"):
        integral_gain(LOOP, SOFT, 0.02, settling)


def test_the_open_loop_with_an_integral():
    forward = add_integral(LOOP, 25.0)
    s = 3 + 4j
    wanted = (s + 25) / s * np.polyval(LOOP.numerator, s) / np.polyval(LOOP.denominator, s)
    found = np.polyval(forward.numerator, s) / np.polyval(forward.denominator, s)
    assert found == pytest.approx(wanted)


def test_the_peak_is_that_of_the_run():
    """Motor, PD and PI as they are, from a ramp on; X waits from the switch on."""
    k, Kp, Ki, v = SOFT, 0.02, 0.5, np.radians(8)
    c, a0, a1 = GAIN / TAU, GAIN * 56.9706 / TAU, (1 + GAIN) / TAU
    # States theta, w = omega - c u, the integral, and 1; u = X + Kp (Fd - k theta) + integral.
    X = FD / k + v / (GAIN * 56.9706)
    u = np.array([-Kp * k, 0, 1, X + Kp * FD])
    omega = np.array([0, 1, 0, 0]) + c * u
    turn = a0 * (u - np.array([1, 0, 0, 0])) - a1 * omega
    A = np.array([omega, turn, [-Ki * k, 0, 0, Ki * FD], np.zeros(4)])
    # w' = omega' - c u' and omega' = turn + c u'.
    state, step = np.array([FD / k, v - c * X, 0, 1]), expm(A * 1e-4)
    peak = 0.0
    for _ in range(8000):
        peak, state = max(peak, k * state[0]), step @ state
    assert k * state[0] == pytest.approx(FD, rel=1e-3)
    found = peak_force(LOOP, k, Kp, Approach("reference", v, FD, Ki))
    assert found == pytest.approx(peak, rel=1e-6)


def test_a_spec_that_asks_for_damping_and_settling():
    force = "{type: pi-force, environment: soft, damping_ratio: 0.741, settling_time: 0.3 s}"
    controllers = {"position": POSITION, "force": force}
    spec = parse_spec(text_of(controllers, more="idle_states: {decay: 20 1/s}"))
    plant = build_plant(spec)
    design = design_controllers(spec, plant)
    # Thesis 6.3.3.1 at Kp = 0.02: a damping ratio of 0.741 before the integral is added.
    assert float(design.laws["force"].gains["Kp"]) == pytest.approx(0.02, rel=0.02)
    (found,) = analyze_design(spec, plant, design).force
    assert found.steady_error == 0
    assert found.loop.poles[0].real == pytest.approx(-4 / 0.3, rel=5e-3)
