"""What is felt of a sampled law: against runs, the continuous law, and random parameters."""

from dataclasses import replace
from fractions import Fraction
from math import pi

import numpy as np
import pytest

from nrs_design.controllers.float32 import to_float32
from nrs_design.controllers.laws import Admittance, ProportionalDerivative
from nrs_design.controllers.sensor import LowPass
from nrs_design.design.sampled_response import SampledAdmittance, largest_sampled_impedance
from nrs_design.models.actuator import ActuatorRanges
from nrs_design.models.interval import Interval
from tests.design.motion_loops import PLACE

PD = ProportionalDerivative(to_float32(Fraction("117359.436")), Fraction(2060))
POINT = ActuatorRanges.point(PLACE.motor)


def interval(low, high):
    return Interval(to_float32(Fraction(low)), *(to_float32(Fraction(end)) for end in (low, high)))


def shown(Mt="0.01", Bt="2", period="0.01", method="exact", low_pass=None):
    law = Admittance(to_float32(Fraction(Mt)), to_float32(Fraction(Bt)))
    return SampledAdmittance(PD, POINT, law, method, Fraction(period), low_pass)


def felt_in_a_run(one, samples):
    """Return force over velocity of a run with so many samples a turn, at its frequency."""
    T, tau, Km = (float(x) for x in (one.period, PLACE.motor.time_constant, PLACE.motor.gain))
    numbers = {k: float(v) for k, v in one.law.discretize(one.period, one.method).numbers.items()}
    held = None if one.low_pass is None else one.low_pass.discretize(one.period)
    D, omega, fine = float(PD.over(one.period)), 2 * pi / (samples * T), 100
    inside = (np.arange(fine) + 0.5) * T / fine
    theta = velocity = reference = vm = before = x = 0.0
    spectrum = 0.0
    for n in range(60 * samples):
        force = np.cos(omega * n * T)
        if held is not None:
            x = force = float(held.p) * x + float(held.q) * force
        error = reference - theta
        u = float(PD.Kp) * error + D * (error - before)
        before = error
        vm = numbers.get("a", 0.0) * vm + numbers["b"] * force
        reference += numbers["T"] * vm
        course = Km * u + (velocity - Km * u) * np.exp(-inside / tau)
        if n >= 59 * samples:
            spectrum += (course * np.exp(-1j * omega * (n * T + inside))).mean()
        theta += Km * u * T + (velocity - Km * u) * tau * -np.expm1(-T / tau)
        velocity = Km * u + (velocity - Km * u) * np.exp(-T / tau)
    # Of a cosine of amplitude 1 the mean is 1/2.
    return samples / abs(2 * spectrum)


@pytest.mark.parametrize(
    "one",
    [
        shown(),
        shown(Mt="0.1", method="euler"),
        shown(Mt="0"),
        shown(low_pass=LowPass(1, Fraction(60))),
    ],
    ids=["exact", "euler", "without inertia", "filtered"],
)
@pytest.mark.parametrize("samples", [6, 40])
def test_against_a_run(one, samples):
    """Five times a second to eight times: the part of the velocity at the frequency of a force."""
    omega = 2 * Fraction("3.14159265358979") / (samples * one.period)
    found = largest_sampled_impedance(one, (omega, omega * Fraction("1.000000001")))
    measured = felt_in_a_run(one, samples)
    assert measured == pytest.approx(float(found.below), rel=1e-4)
    assert measured <= float(found.above) * (1 + 1e-4)
    assert float(found.above) <= measured * 1.01


def test_a_loop_that_is_unstable_in_its_ranges_is_not_judged():
    """With a gain that is ten times as large, the motion loop is unstable at 10 ms."""
    gain = Interval(PLACE.motor.gain, PLACE.motor.gain, 10 * PLACE.motor.gain)
    one = replace(shown(), motor=replace(POINT, gain=gain))
    assert largest_sampled_impedance(one, (Fraction(0), Fraction(10))) is None


def response(omega, T, values):
    """Return ``|F/V|`` by the formula, in floating point."""
    Km, tau, Mt, Bt = (values[name] for name in ("Km", "tau", "Mt", "Bt"))
    z, E = np.exp(1j * omega * T), np.exp(-T / tau)
    s, D = tau * (1 - E), float(PD.Kd) / T
    turned, C = s * (1 - z) + T * (z - E), ((float(PD.Kp) + D) * z - D) / z
    a = np.exp(-Bt * T / Mt)
    U = T * (1 - a) / Bt / (z - a) * C * (z - E) / ((z - 1) * (z - E) + C * Km * turned)
    return 1 / np.abs(Km / (1j * omega * tau + 1) * (1 - 1 / z) / (1j * omega * T) * U)


def test_over_ranges_at_random_parameters():
    """No draw is above the bound, which is within 1 % of what is felt at a corner."""
    ranges = {"Km": interval("4.7e-4", "5e-4"), "tau": interval("0.034", "0.0362")}
    motor = ActuatorRanges(ranges["Km"], ranges["tau"], "rpm")
    one = replace(shown(period="0.002"), motor=motor)
    found = largest_sampled_impedance(one, (Fraction(0), Fraction(40)))
    assert found.below <= found.above <= found.below * Fraction("1.01")
    draw, omega = np.random.default_rng(1), np.linspace(0.1, 40, 200)
    for _ in range(50):
        drawn = {n: draw.uniform(float(r.low), float(r.high)) for n, r in ranges.items()}
        there = response(omega, 0.002, {"Mt": 0.01, "Bt": 2} | drawn)
        assert there.max() <= float(found.above) * (1 + 1e-6)
    at = {"Mt": 0.01, "Bt": 2} | {name: float(value) for name, value in found.at.items()}
    there = response(np.array([max(found.omega, 1e-3)]), 0.002, at)[0]
    assert there == pytest.approx(float(found.below), rel=1e-5)
