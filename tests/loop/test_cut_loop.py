"""The loop that margins are about is the mode that is proved: eigenvalue by eigenvalue."""

import random
from fractions import Fraction

import control
import numpy as np
import pytest

from nrs_design.design.loop_family import LoopFamily
from nrs_design.loop.assemble import assemble
from nrs_design.loop.cut_loop import ProcessorAxis, axis_of, characteristic
from nrs_design.models.contact import KelvinVoigt
from nrs_design.pipeline.runs import run_design
from tests.loop.support import loaded
from tests.support import thinned
from tests.tables import entry, spec_text

# Plants by what they have; every random draw fills in its numbers.
FEATURES = entry(__file__, "features")


def text_of(features, seed):
    """A spec of one controller and one contact, with numbers of its own."""
    draw, words = random.Random(seed), features.split()

    def number(low, high):
        return f"{draw.uniform(low, high):.4g}"

    gain, tau = "4.8417e-4 rad/s/rpm", "0.0351 s"
    if "motor" in words:
        gain = "{nominal: 4.8417e-4 rad/s/rpm, range: [4.7e-4 rad/s/rpm, 5e-4 rad/s/rpm]}"
        tau = "{nominal: 0.0351 s, range: [0.034 s, 0.0365 s]}"
    load = f", load_inertia: {number(0.1, 2)} kg*m^2" if "load" in words else ""
    damping = f", damping: {number(0.05, 0.4)} N*m*s/rad" if "damping" in words else ""
    model = "kelvin-voigt" if damping else "elastic"
    spring = f", Kt: {number(0.2, 3)} N*m/rad" if "spring" in words else ""
    mass = "0" if "static" in words else number(0.005, 0.05)
    lines = [
        "kind: interaction-design",
        "name: one",
        f"actuator: {{gain: {gain}, time_constant: {tau}{load}}}",
        "motion_loop: {damping_ratio: 0.707, settling_time: 0.1404 s, "
        "derivative_gain: 2060 rpm*s/rad, zero: 56.9706 1/s}",
        "limits: {velocity: 8 deg/s, torque: 0.3 N*m, bandwidth: 2 Hz}",
        f"environments: {{soft: {{model: {model}, stiffness: "
        f"{{nominal: 40 N*m/rad, range: [35 N*m/rad, {number(42, 50)} N*m/rad]}}{damping}}}}}",
        "controllers: {a: {type: impedance, environment: soft, "
        f"Mt: {mass} kg*m^2, Bt: {number(1.5, 3)} N*m*s/rad{spring}}}}}",
        "switching: arbitrary",
    ]
    if "filter" in words:
        lines.append(f"sensor: {{filter: {{cutoff: {number(100, 400)} rad/s, order: 2}}}}")
    if "sampled" in words:
        outer = ", outer_period: 4 ms" if "slow" in words else ""
        delay = draw.choice((1, 3)) if "late" in words else 0
        lines.append(f"sampling: {{period: 2 ms{outer}, delay: {delay}}}")
    return "\n".join(lines) + "\n"


def one(features, seed):
    designed = run_design(loaded(text_of(features, seed)))
    axis = axis_of(designed.spec, designed.plant, designed.design.motion, designed.design.sensor)
    return designed, axis


def z_plane(polynomial, period):
    """The roots, and the eigenvalues that they stand for."""
    w = np.roots([float(c) for c in polynomial])
    return w if period is None else (1 + w * period / 2) / (1 - w * period / 2)


# Sampled, ranges of the motor make a triangle, which has corners that no motor is at.
@pytest.mark.parametrize("features", [f for f in FEATURES.values() if "sampled motor" not in f])
@pytest.mark.parametrize("seed", thinned(range(6), 1))
def test_the_closed_loop_is_a_mode_of_the_proof(features, seed):
    """Every corner of the assembled system has the roots of a closed loop that is looked at."""
    designed, axis = one(features, seed)
    period = None if axis.period is None else float(axis.period)
    (controller,), soft = designed.design.controllers, designed.plant.environment("soft")
    closed = [
        z_plane(axis.find_loop(controller.law, contact, place).closed, period)
        for contact in (soft.nominal, *soft.corners)
        for place in axis.places
    ]
    system = assemble(designed.spec, designed.plant, designed.design)
    modes = {mode.name: np.array(mode.A.floats()) for mode in system.modes}
    if "slow" in features:
        between = next(A for name, A in modes.items() if name.startswith("motion"))
        modes = {n: between @ A for n, A in modes.items() if not n.startswith("motion")}
    for name, A in modes.items():
        found = np.linalg.eigvals(A)
        assert any(
            all(np.abs(found - root).min() < 1e-5 * (1 + abs(root)) for root in roots)
            for roots in closed
        ), name


@pytest.mark.parametrize("features", FEATURES.values(), ids=FEATURES)
@pytest.mark.parametrize("seed", thinned(range(7, 13), 1))
def test_margins_and_limit_against_python_control_and_eigenvalues(features, seed):
    """The open loop is that of python-control, by state space; the limit by the spectrum."""
    designed, axis = one(features, seed)
    (controller,), soft = designed.design.controllers, designed.plant.environment("soft")
    gains = controller.law.gains
    Mt, Bt = float(gains["Mt"]), float(gains["Bt"])
    place = axis.places[-1]
    family = LoopFamily(axis, soft.nominal, gains.get("Kt", Fraction(0)), place)
    loops = family.loops(np.array([Mt]), np.array([Bt]), 40.0)
    exact = axis.find_loop(controller.law, soft.nominal, place)
    period = None if axis.period is None else float(axis.period)
    scale = float(exact.closed[0]) / loops.closed[0][np.flatnonzero(loops.closed[0])[0]]
    kept = loops.closed[0][-len(exact.closed) :] * scale
    assert kept == pytest.approx([float(c) for c in exact.closed], rel=1e-5)

    def stable(k):
        contact = KelvinVoigt(Fraction(k), getattr(soft.nominal, "b", Fraction(0)))
        roots = z_plane(axis.find_loop(controller.law, contact, place).closed, period)
        return (np.abs(roots) < 1).all() if period else (roots.real < 0).all()

    limit = family.stiffness_limit(Mt, Bt)
    assert limit == np.inf or (stable(0.999 * limit) and not stable(1.001 * limit))
    assert loops.stable[0] == stable(40)
    if not loops.stable[0]:
        return
    n = loops.numerator[0], loops.denominator[0]
    tf = control.TransferFunction(*(np.trim_zeros(p, "f") for p in n))
    top = np.inf if period is None else 2 / period * np.tan(0.999999 * np.pi / 2)
    nu = np.geomspace(1e-2, min(1e5, top), 200_001)
    L = np.polyval(n[0], 1j * nu) / np.polyval(n[1], 1j * nu)
    assert loops.sensitivity_peak()[0] == pytest.approx(max(1, np.abs(1 / (1 + L)).max()), rel=1e-4)
    assert loops.disk_margin()[0] == pytest.approx(1 / np.abs(1 / (1 + L) - 0.5).max(), rel=1e-3)
    gain, phase, *_ = control.margin(tf)
    assert loops.phase_margin()[0] <= np.radians(abs(phase)) * (1 + 1e-6)
    assert loops.gain_margin()[0] <= gain * (1 + 1e-6) if gain > 1 else True


@pytest.mark.parametrize("late", thinned(["sampled", "sampled damping", "sampled filter"], 1))
def test_a_force_that_is_older_by_the_delay_margin_is_stable_and_by_more_is_not(late):
    designed, axis = one(late, 3)
    assert isinstance(axis, ProcessorAxis)
    (controller,), soft = designed.design.controllers, designed.plant.environment("soft")
    gains = controller.law.gains
    family = LoopFamily(axis, soft.nominal, Fraction(0), axis.places[0])
    loops = family.loops(np.array([float(gains["Mt"])]), np.array([float(gains["Bt"])]), 40.0)
    samples = round(loops.delay_margin()[0] / 0.002)
    assert samples > 2

    def stable(age):
        place = type(axis.places[0])(axis.places[0].motor, age)
        roots = z_plane(axis.find_loop(controller.law, soft.nominal, place).closed, 0.002)
        return (np.abs(roots) < 1).all()

    assert all(map(stable, range(samples + 1)))
    assert not stable(samples + 1)


def test_characteristic_polynomial():
    rows = [[Fraction(1, 2), Fraction(1)], [Fraction(0), Fraction(1, 3)]]
    assert characteristic(rows) == (1, Fraction(-5, 6), Fraction(1, 6))


def test_a_force_that_is_sampled_more_often_than_the_motion_loop_has_no_axis():
    faster = "2 ms,", "2 ms, outer_period: 1 ms,"
    designed = run_design(loaded(text_of("sampled", 0), faster))
    design = designed.design
    assert axis_of(designed.spec, designed.plant, design.motion, design.sensor) is None


STREAMED = spec_text("streamed-spring")


def test_a_spring_on_the_measured_position_is_cut_with_the_force():
    """L = C (k/z + Kt) P: so its margins are those of the command, which is late or too large."""
    found = run_design(loaded(STREAMED))
    axis = axis_of(found.spec, found.plant, found.design.motion, found.design.sensor)
    (contact,) = found.plant.environment("tissue").corners
    loop = axis.find_loop(found.design.controllers[0].law, contact, axis.places[0])
    T, (a, b) = 0.002, (np.exp(-10 / 0.1 * 0.002), (1 - np.exp(-10 / 0.1 * 0.002)) / 10)
    plant = control.c2d(control.ss(control.tf([1], [0.03, 1, 0])), T)
    for omega in (1.0, 8.0, 40.0, 300.0):
        z, w = np.exp(1j * omega * T), 2 / T * np.tan(omega * T / 2) * 1j
        opened, closed = (np.polyval([float(c) for c in p], w) for p in (loop.opened, loop.closed))
        law = b * z / (z - a)
        expected = law * (40 / z + 80) * plant(z)
        assert closed / opened - 1 == pytest.approx(expected, rel=1e-5)
