"""Where a displayed admittance is passive: by hand, on the robot of the thesis, and on a grid."""

from fractions import Fraction
from itertools import product
from math import pi, sin

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nrs_design.controllers.float32 import to_float32
from nrs_design.controllers.laws import Admittance, DiscreteLaw, ProportionalDerivative
from nrs_design.controllers.sensor import LowPass
from nrs_design.controllers.step_law import StepFrame
from nrs_design.design.affine_family import polynomial
from nrs_design.design.passivity import first_root, real_parts, sampled_bands
from nrs_design.design.passivity import passive_band as band_of
from nrs_design.design.sampled_response import SampledAdmittance
from nrs_design.loop.cut_loop import ContinuousAxis
from nrs_design.loop.parameter_box import Joint
from nrs_design.loop.program import INPUTS
from nrs_design.models.actuator import Actuator, ActuatorRanges
from nrs_design.models.motion_loop import MotionLoop, realize
from nrs_design.thesis import thesis
from tests.design.motion_loops import LAG, PD, PLACE, interval
from tests.loop.frames import frame_of
from tests.support import thinned

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


@pytest.mark.parametrize(
    ("Mt", "Bt", "hertz"),
    [(1, 4, 2.263), (2, 4, 1.643), (3, 4, 1.355), (1, 8, 3.06), (3, 8, 1.880)],
)
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
    point = ActuatorRanges.point(PLACE.motor)
    joint = None if J is None else Joint(PD, point, Fraction(J))
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
    ranges = {
        "Mt": interval("0.008", "0.02"),
        "Bt": interval("1.5", "2.6"),
        "Km": interval("4.7e-4", "5e-4"),
        "tau": interval("0.033", "0.037"),
    }
    low_pass = LowPass(1, Fraction(150)) if filtered else None
    axis_ = loaded(J, low_pass)
    if J is None:  # Ranges of the motor need it in its physical state.
        ranges = {name: ranges[name] for name in ("Mt", "Bt")}
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


MOTOR = Actuator(Fraction("4.8417e-4"), Fraction("0.0351"))
MOTION = ProportionalDerivative(to_float32(Fraction("117359.436")), Fraction(2060))
PERIOD = Fraction("0.002")


def shown(Mt, Bt, period=PERIOD):
    law = Admittance(*(to_float32(Fraction(gain)) for gain in (Mt, Bt)))
    return SampledAdmittance(MOTION, ActuatorRanges.point(MOTOR), law, "exact", period)


def law_of(Mt, Bt, period=PERIOD):
    return shown(Mt, Bt, period).law.discretize(period, "exact").numbers


def real_part(omega, law, period, age):
    """Return Re V by the formula in floating point, from the matrices that a proof is about."""
    E = Fraction(float(np.exp(-float(period / MOTOR.time_constant))))
    held = DiscreteLaw(Admittance, law)
    step = StepFrame(MOTION.Kp, MOTION.over(period))
    frame = frame_of(period, step, (held,), age, MOTOR.time_constant)
    rows = frame.rows(held, age, {"Km": MOTOR.gain})
    n = len(frame.states)
    # The velocity that the command holds on to; the last state only counts the angle.
    A = np.array([[float(v) for v in row[:n]] for row in rows[:n]])
    B = np.array([float(row[n + INPUTS.index("force error")]) for row in rows[:n]])
    z = np.exp(1j * omega * float(period))
    inner, pushed = A[:-1, :-1], B[:-1]
    states = np.linalg.solve(
        z[:, None, None] * np.eye(n - 1) - inner,
        np.broadcast_to(pushed, (len(z), n - 1))[..., None],
    )
    speed = states[:, frame.states.index("omega [rad/s]"), 0]
    command = (z - float(E)) * speed / float(MOTOR.gain * (1 - E))
    tau, T = float(MOTOR.time_constant), float(period)
    held = float(MOTOR.gain) / (tau * 1j * omega + 1) * (1 - 1 / z) / (1j * omega * T)
    # A force of the hand is one that the environment does not exert.
    return -(held * command).real


@pytest.mark.parametrize("period", thinned(["0.002", "0.01"], 1))
@pytest.mark.parametrize(("Mt", "Bt"), [(1, 4), (3, 8), ("0.01", "2.15"), (0, "2.15")])
def test_against_a_scan(Mt, Bt, period):
    """The first frequency of a dense scan with a negative real part is where the band ends."""
    T = Fraction(period)
    law = law_of(Mt, Bt, T)
    for band in sampled_bands(shown(Mt, Bt, T), (0, 1, 5)):
        low, high = map(float, band.broken)
        omega = np.linspace(1e-2, pi / float(T) * 0.99, 5000)
        found = omega[real_part(omega, law, T, band.age) < 0]
        assert low == pytest.approx(2 / float(T) * np.arctan(float(band.tangent)), abs=2e-9)
        assert float(band.passive) < low <= high < float(band.passive) * 1.0001
        assert found[0] - (omega[1] - omega[0]) <= high
        assert found[0] >= float(band.passive)
        ends = real_part(np.array([float(band.passive), high]), law, T, band.age)
        assert ends[0] > -1e-9 * abs(ends).max() > ends[1] or ends[0] > 0 > ends[1]


@pytest.mark.parametrize("age", [0, 2])
def test_a_run(age):
    """Mean power of a sinusoidal force on a run of the law, motor followed between samples."""
    T = Fraction("0.01")
    law = law_of(1, 4, T)
    (band,) = sampled_bands(shown(1, 4, T), (age,))
    for factor, gives in ((0.97, False), (1.03, True)):
        # A whole number of oscillations in a whole number of samples.
        samples = 4000
        turns = round(factor * float(band.passive) * samples * float(T) / (2 * pi))
        omega = 2 * pi * turns / (samples * float(T))
        power = _work(law, float(T), age, lambda t, w=omega: sin(w * t), samples)
        assert (power < 0) == gives


def _work(law, T, age, force, samples, settled=2000):
    """Return the energy that a force puts into the robot within the last samples of a run."""
    Km, tau, parts = float(MOTOR.gain), float(MOTOR.time_constant), 20
    Kp, D = float(MOTION.Kp), float(MOTION.over(Fraction(T).limit_denominator(1000)))
    theta = omega = before = reference = velocity = work = 0.0
    late = [0.0] * age
    fine = np.arange(parts) / parts * T + T / parts / 2
    shrink, s = np.exp(-T / tau), tau * (1 - np.exp(-T / tau))
    for k in range(settled + samples):
        late = [*late, force(k * T)]
        error = reference - theta
        u = Kp * error + D * (error - before)
        before = error
        reference += T * velocity
        velocity = float(law["a"]) * velocity + float(law["b"]) * late.pop(0)
        if k >= settled:
            speeds = Km * u + (omega - Km * u) * np.exp(-fine / tau)
            work += sum(force(k * T + t) * v for t, v in zip(fine, speeds, strict=True)) * T / parts
        theta += s * omega + Km * (T - s) * u
        omega = shrink * omega + Km * (1 - shrink) * u
    return work


def test_what_is_not_decided():
    # The motion loop itself is not stable at half the rate.
    assert sampled_bands(shown(1, 4, Fraction("0.08")), (0,)) == ()
