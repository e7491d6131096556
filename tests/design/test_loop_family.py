"""Margins from assembled modes, against the loop of the thesis, python-control and brute force."""

import math
from fractions import Fraction
from types import SimpleNamespace

import control
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from nrs_design.design.impedance_optimum import ImpedanceLoop
from nrs_design.design.loop_family import LoopFamily
from nrs_design.design.loops import Loops
from nrs_design.design.transfer import TransferFunction, frequency_response, to_control
from nrs_design.models.contact import Elastic, KelvinBoltzmann, KelvinVoigt, Maxwell
from tests.design.classical import closed_loop_polynomial, open_loop
from tests.design.motion_loops import EXACT, PLACE, axis_with
from tests.tables import rows

SOFT = ImpedanceLoop(EXACT, Elastic(43.0356))

masses = st.one_of(st.just(0.0), st.floats(1e-3, 0.05))
dampings = st.one_of(st.just(0.0), st.floats(0.01, 0.5))


def family(loop):
    return LoopFamily(axis_with(loop.motion), loop.contact, Fraction(loop.Kt), PLACE)


def stiffness_limit(loop, Mt, Bt):
    return family(loop).stiffness_limit(Mt, Bt)


def margins_of(loops):
    names = ("sensitivity_peak", "peak_frequency", "gain_margin")
    names += ("phase_margin", "delay_margin", "disk_margin")
    return SimpleNamespace(**{name: float(getattr(loops, name)()[0]) for name in names})


def margins_at(loop, Mt, Bt):
    gains = np.array([Mt]), np.array([Bt])
    return margins_of(family(loop).loops(*gains, loop.contact.stiffness))


def bisect_limit(motion, damping, Mt, Bt, high=1e7):
    """Largest stiffness with all roots in the left half plane, by bisection on the roots."""

    def stable(k):
        roots = np.roots(
            closed_loop_polynomial(ImpedanceLoop(motion, KelvinVoigt(k, damping)), Mt, Bt)
        )
        return roots.real.max() < 0

    low = 1e-3
    assert stable(low)
    assert not stable(high)
    for _ in range(100):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if stable(middle) else (low, middle)
    return low


@pytest.mark.parametrize(
    ("Bt", "limit", "tolerance"), rows(__file__, "test_known_stiffness_limits")
)
def test_known_stiffness_limits(Bt, limit, tolerance):
    found = stiffness_limit(SOFT, 0.01, Bt)
    assert found == pytest.approx(limit, abs=tolerance)
    assert found == pytest.approx(bisect_limit(EXACT, 0.0, 0.01, Bt), rel=1e-6)


@given(Mt=masses, Bt=st.floats(0.3, 10), damping=dampings)
def test_stiffness_limit_agrees_with_bisection(Mt, Bt, damping):
    found = stiffness_limit(ImpedanceLoop(EXACT, KelvinVoigt(1.0, damping)), Mt, Bt)
    assume(0.01 < found < 1e6)
    assert found == pytest.approx(bisect_limit(EXACT, damping, Mt, Bt), rel=1e-5)


def test_loop_that_no_stiffness_destabilizes():
    first_order = TransferFunction((1.0,), (0.05, 1.0))
    assert stiffness_limit(ImpedanceLoop(first_order, Elastic(1.0)), 0.0, 1.0) == math.inf


def test_loop_that_every_stiffness_destabilizes():
    unstable = TransferFunction((1.0,), (1.0, -0.5, 1.0))
    assert stiffness_limit(ImpedanceLoop(unstable, Elastic(1.0)), 0.0, 1.0) == 0.0
    reversed_sign = TransferFunction((-1.0,), (0.05, 1.0))
    assert stiffness_limit(ImpedanceLoop(reversed_sign, Elastic(1.0)), 0.0, 1.0) == 0.0


def polynomials(tf):
    return tf.numerator, tf.denominator


def test_delay_margin_takes_the_smallest_over_all_crossovers():
    # A notch at 8 rad/s before a resonance at 10 rad/s: three crossovers, the last one counts.
    resonant = TransferFunction((1.5625, 0.1, 100.0), (1.0, 0.2, 100.0))
    loop = ImpedanceLoop(resonant, Elastic(0.5))
    tf = open_loop(loop, 0.0, 1.0)
    margins = margins_of(Loops(*(np.array([np.pad(p, (4 - len(p), 0))]) for p in polynomials(tf))))
    _, phases, _, _, at, _ = control.stability_margins(
        to_control(open_loop(loop, 0.0, 1.0)), returnall=True
    )
    assert len(at) == 3
    delays = np.radians(np.mod(phases, 360)) / at
    assert margins.delay_margin == pytest.approx(delays.min())
    assert delays.min() < 0.5 * delays[0]
    smallest_phase = np.argmin(np.abs(phases))
    assert margins.phase_margin == pytest.approx(math.radians(abs(phases[smallest_phase])))


def test_integrator_alone_has_the_margins_of_the_textbook():
    # L = 1/s: no gain limit, 90 degrees, a delay of pi/2 s, |S| below 1 everywhere.
    margins = margins_of(Loops(np.array([[0.0, 1.0]]), np.array([[1.0, 0.0]])))
    assert margins.gain_margin == math.inf
    assert margins.phase_margin == pytest.approx(math.pi / 2)
    assert margins.delay_margin == pytest.approx(math.pi / 2)
    assert margins.sensitivity_peak == 1.0
    assert margins.peak_frequency == math.inf
    assert margins.disk_margin == 2.0


@pytest.mark.parametrize(
    "contact", [Maxwell(43.0, 4.0), Maxwell(43.0, 400.0), KelvinBoltzmann(20.0, 43.0, 3.0)]
)
@pytest.mark.parametrize("Mt", [0.0, 0.01])
def test_margins_in_viscoelastic_contact(contact, Mt):
    loop = ImpedanceLoop(EXACT, contact)
    margins, tf = margins_at(loop, Mt, 2.15), open_loop(loop, Mt, 2.15)
    gain, phase, *_ = control.stability_margins(to_control(tf))
    assert margins.gain_margin == pytest.approx(gain)
    if math.isfinite(phase):
        assert margins.phase_margin == pytest.approx(math.radians(phase))
    S = 1 / (1 + frequency_response(tf, np.geomspace(1e-3, 1e5, 200_001)))
    assert margins.sensitivity_peak == pytest.approx(max(1.0, np.abs(S).max()), rel=1e-6)
    assert margins.disk_margin == pytest.approx(1 / np.abs(S - 0.5).max(), rel=1e-6)
    # All parameters grow alike: the stiffness is the loop gain.
    assert stiffness_limit(loop, Mt, 2.15) == pytest.approx(43.0 * margins.gain_margin, rel=1e-6)
