"""Where a displayed admittance is passive: by hand, on the robot of the thesis, and on a grid."""

from fractions import Fraction
from itertools import product
from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nrs_design.controllers.laws import Admittance
from nrs_design.controllers.sensor import LowPass
from nrs_design.design.affine_family import polynomial
from nrs_design.design.passivity import first_root, real_parts
from nrs_design.design.passivity import passive_band as band_of
from nrs_design.loop.cut_loop import ContinuousAxis
from nrs_design.loop.parameter_box import Joint
from nrs_design.models.actuator import ActuatorRanges
from nrs_design.models.interval import Interval
from nrs_design.models.motion_loop import MotionLoop, realize
from nrs_design.thesis import thesis
from tests.design.motion_loops import LAG, PD, PLACE, interval
from tests.tables import rows

ONE = Fraction(1)


def axis(loop):
    return ContinuousAxis((PLACE,), realize(loop))


def passive_band(loop, Mt, Bt):
    return band_of(axis(loop), Admittance(Mt, Bt), {})


def test_by_hand():
    """G = 1/(s + 1): Re (M j w + B)(j w + 1) = B - M w^2, so up to the root of B/M."""
    (P,) = real_parts(axis(LAG), Admittance(Fraction(2), Fraction(8)), {})
    assert P[0] * polynomial(-Fraction(2, 8), ONE) == P
    band = passive_band(LAG, Fraction(2), Fraction(8))
    assert Fraction(19999, 10000) < band.passive <= 2
    assert 2 < band.broken < Fraction(20001, 10000)
    # Without inertia it is passive at every frequency.
    static = passive_band(LAG, Fraction(0), Fraction(8))
    assert (static.passive, static.broken) == (None, None)


def test_a_loop_that_pushes_back_is_not_passive_at_rest():
    band = passive_band(MotionLoop((-ONE,), (ONE, ONE)), ONE, ONE)
    assert (band.passive, band.broken) == (0, None)


@pytest.mark.parametrize(("Mt", "Bt", "hertz"), rows(__file__, "test_the_robot_of_the_thesis"))
def test_the_robot_of_the_thesis(Mt, Bt, hertz):
    """Chapter 7; 1.36 Hz and 3.06 Hz are what an independent program rounds to."""
    band = passive_band(thesis.CLOSED_LOOP, Fraction(Mt), Fraction(Bt))
    assert float(band.passive) / (2 * pi) == pytest.approx(hertz, rel=3e-3)
    assert band.passive < band.broken < band.passive * Fraction(10001, 10000)


@pytest.mark.parametrize(
    ("roots", "first"), [([1, 1, 2, -3], 1), ([-1, -2], None), ([3, 2, -2], 2), ([1j, -1j, 5], 5)]
)
def test_first_positive_root(roots, first):
    found = first_root(polynomial(*(Fraction(int(c.real)) for c in np.poly(roots).round())))
    assert (found is None) == (first is None)
    if found is not None:
        assert found[0] <= first <= found[1] < first + Fraction(1, 10**12)


def test_a_root_that_is_no_fraction_is_enclosed():
    low, high = first_root(polynomial(ONE, Fraction(0), Fraction(-2)))
    assert low**2 < 2 < high**2
    assert high - low < Fraction(1, 10**12)


@settings(deadline=None)
@given(
    st.lists(st.integers(1, 50), min_size=2, max_size=2),
    st.lists(st.integers(1, 50), min_size=3, max_size=3),
    st.integers(0, 20),
    st.integers(1, 20),
)
def test_against_a_grid(numerator, denominator, Mt, Bt):
    """Below the band the real part is positive, and where it is refuted it is negative."""
    loop = MotionLoop(tuple(map(Fraction, numerator)), tuple(map(Fraction, denominator)))
    band = passive_band(loop, Fraction(Mt), Fraction(Bt))

    def real(omega: np.ndarray) -> np.ndarray:
        s = 1j * omega
        return ((Mt * s + Bt) * np.polyval(denominator, s) / np.polyval(numerator, s)).real

    end = 1e3 if band.passive is None else float(band.passive)
    assert (real(np.linspace(0, end, 400)) > -1e-6 * Bt).all()
    if band.broken is not None:
        assert real(np.array([float(band.broken)]))[0] < 1e-9


def response(omega, values, J, lags=()):
    """From the torque of a hand to the velocity of the tool, by the equations of the loop."""
    s = 1j * np.asarray(omega, dtype=float)
    Km, tau, Mt, Bt, Kt = (float(values[name]) for name in ("Km", "tau", "Mt", "Bt", "Kt"))
    law = s / (Mt * s**2 + Bt * s + Kt)
    for pole in lags:
        law = law * pole / (s + pole)
    pull = float(PD.Kp) / s + float(PD.Kd)
    torque = tau / float(J) if J else 0.0
    return (Km * pull * law + torque) / (tau * s + 1 + Km * pull)


NUMBERS = {"Km": "4.8417e-4", "tau": "0.0351", "Mt": "0.01", "Bt": "2.15", "Kt": "0"}
NOMINAL = {name: Fraction(value) for name, value in NUMBERS.items()}


def loaded(J, low_pass=None):
    gain, lag = Interval.point(PLACE.motor.gain), Interval.point(PLACE.motor.time_constant)
    point = ActuatorRanges(gain, lag, PLACE.motor.command)
    joint = Joint(PD, point, None if J is None else Fraction(J))
    motion = PLACE.motor.gain * PD.Kd, PLACE.motor.gain * PD.Kp
    loop = MotionLoop(motion, (PLACE.motor.time_constant, 1 + motion[0], motion[1]))
    return ContinuousAxis((PLACE,), realize(loop), joint, low_pass)


def test_a_load_makes_it_passive_where_the_unloaded_one_is_not():
    """J = 0.3 kg m^2: at 60.90 rad/s, where G Y ends to be passive, Re Y is +0.043."""
    law = Admittance(NOMINAL["Mt"], NOMINAL["Bt"])
    plain = band_of(loaded(None), law, {})
    assert float(plain.passive) == pytest.approx(60.9019, abs=1e-3)
    assert response(60.90, NOMINAL, "0.3").real == pytest.approx(0.043, abs=1e-3)
    heavy = band_of(loaded("0.3"), law, {})
    assert heavy.passive is None or heavy.passive > plain.passive
    if heavy.broken is not None:
        assert response(float(heavy.broken), NOMINAL, "0.3").real < 0


@pytest.mark.parametrize("J", [None, "0.3", "3"])
@pytest.mark.parametrize("filtered", [False, True])
@pytest.mark.parametrize("spring", ["0", "0.8"])
def test_over_ranges_against_the_response(J, filtered, spring):
    """Passive below the band at random points of the box; at a corner of it not where refuted."""
    ranges = {"Km": interval("4.7e-4", "5e-4"), "tau": interval("0.033", "0.037")}
    low_pass = LowPass(1, Fraction(150)) if filtered else None
    axis_ = loaded(J, low_pass)
    law = Admittance(NOMINAL["Mt"], NOMINAL["Bt"], Fraction(spring))
    band = band_of(axis_, law, ranges)
    lags = (150.0,) if filtered else ()
    draw = np.random.default_rng(1)
    end = 1e3 if band.passive is None else float(band.passive)
    omega = np.linspace(1e-3, end, 300)
    nominal = NOMINAL | {"Kt": Fraction(spring)}
    for _ in range(40):
        values = {n: draw.uniform(float(r.low), float(r.high)) for n, r in ranges.items()}
        real = response(omega, nominal | values, J, lags).real
        assert real.min() > -1e-9
    if band.broken is not None:
        corners = product(*((r.low, r.high) for r in ranges.values()))
        worst = [
            response(float(band.broken), nominal | dict(zip(ranges, at, strict=True)), J, lags).real
            for at in corners
        ]
        assert min(worst) < 0
        assert band.passive < band.broken
