"""Where a sampled admittance is passive: beside a grid, the matrices of a proof, and a run."""

from fractions import Fraction
from math import pi, sin

import numpy as np
import pytest

from nrs_design.controllers.float32 import to_float32
from nrs_design.controllers.laws import Admittance, DiscreteLaw, ProportionalDerivative
from nrs_design.controllers.step_law import StepFrame
from nrs_design.design.passivity import sampled_bands
from nrs_design.design.sampled_response import SampledAdmittance
from nrs_design.loop.program import INPUTS
from nrs_design.models.actuator import Actuator, ActuatorRanges
from tests.loop.frames import frame_of
from tests.support import thinned

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
