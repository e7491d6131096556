"""A PI force controller beside others: what its integral does in every mode, and at rest."""

from fractions import Fraction

import numpy as np
import pytest
from flint import fmpq as rational
from flint import fmpq_mat
from scipy.integrate import solve_ivp

from nrs_design.loop.assemble import assemble
from nrs_design.pipeline.runs import run_design
from nrs_design.search.certify import certify
from tests.loop.support import assembled, loaded
from tests.simulation.interactions import FORCE, INSERTION, POSITION, simulated, text_of

PI = "{type: pi-force, environment: soft, proportional_gain: 0.02 rad/(N*m), "
PI += "integral_gain: 0.5 rad/(N*m*s)}"
BOTH = {"position": POSITION, "force": PI}
IDLE = "idle_states: {decay: 20 1/s}"
KM, TAU, KD, KP = 4.8417e-4, 0.0351, 2060.0, float(np.float32(2060 * 56.9706))
GAIN = float(np.float32(0.02))


def matrices(system):
    return {
        mode.name: np.array(mode.A.numerators, float) / mode.A.denominator for mode in system.modes
    }


def to_states(system, theta, omega, reference):
    """Return xi: ``theta = C xi`` and ``omega = C (A xi + B u)``, u the reference."""
    A = matrices(system)["position"][:2, :2]
    c = np.array([-A[1, 0], KM * KD / TAU])
    rows = np.array([c, c @ A])
    return np.linalg.solve(rows, [theta, omega - c[1] * reference])


@pytest.mark.parametrize("controller", ["position", "force", "insertion", "hold"])
def test_run_against_motor_and_firmware(controller):
    """Motor, PD, admittance and integral as they are, against the mode of the controller."""
    system = assembled(text_of(BOTH | {"insertion": INSERTION, "hold": FORCE}, more=IDLE))
    assert system.states == ("xi1", "xi2", "vm [rad/s]", "reference [rad]", "integral [rad]")
    k, Mt, Bt = 43.0, float(np.float32(0.01)), float(np.float32(2.15))

    def command(theta, r, w):
        return {"position": 0.0, "insertion": r}.get(controller, -GAIN * k * theta) + w

    def rate(_, x):
        theta, omega, vm, r, w = x
        force = k * theta
        held = controller == "insertion"
        dvm, dr = ((force - Bt * vm) / Mt, -vm) if held else (-20 * vm, -20 * r)
        dw = -0.5 * force if controller == "force" else -20 * w
        du = dw + {"position": 0.0, "insertion": dr}.get(controller, -GAIN * k * omega)
        drive = KP * (command(theta, r, w) - theta) + KD * (du - omega)
        return [omega, (KM * drive - omega) / TAU, dvm, dr, dw]

    start = np.array([1e-3, 2e-2, 0.05, 0.02, 0.004])
    times = np.linspace(0, 0.3, 7)
    wanted = solve_ivp(rate, (0, 0.3), start, "DOP853", times, rtol=1e-11, atol=1e-14).y
    name = "position" if controller == "position" else f"{controller}/soft"
    A = matrices(system)[name]
    theta, omega, vm, r, w = start
    xi = to_states(system, theta, omega, command(theta, r, w))
    run = solve_ivp(
        lambda _, x: A @ x, (0, 0.3), [*xi, vm, r, w], "DOP853", times, rtol=1e-11, atol=1e-14
    ).y
    c = np.array([-matrices(system)["position"][1, 0], KM * KD / TAU])
    assert c @ run[:2] == pytest.approx(wanted[0], abs=1e-10)
    assert run[2:] == pytest.approx(wanted[2:], abs=1e-9)


@pytest.mark.parametrize("stiffness", ["41", "43", "44.5"])
def test_no_force_error_is_left(stiffness):
    """Exactly: the only rest of the mode under a constant Fd and X has the force Fd."""
    soft = f"{{model: elastic, stiffness: {stiffness} N*m/rad}}"
    found = run_design(loaded(text_of(BOTH, {"soft": soft}, more=IDLE)))
    design, system = found.design, assemble(found.spec, found.plant, found.design)
    A = next(mode.A for mode in system.modes if mode.name == "force/soft").fractions()
    law, (wanted, X) = design.laws["force"], (Fraction("0.3"), Fraction("0.11"))
    # u has X + Kp Fd besides, and the integral gathers Ki Fd; xi' = Ap xi + Bp u with Bp = (0, 1).
    given = [Fraction(0), X + law.Kp * wanted, law.Ki * wanted]
    left = fmpq_mat(3, 3, [rational(a.numerator, a.denominator) for row in A for a in row])
    right = fmpq_mat(3, 1, [rational(-g.numerator, g.denominator) for g in given])
    rest = left.solve(right)
    # At rest the angle is xi1 times the constant of the denominator, as G(0) = 1.
    position = next(mode.A for mode in system.modes if mode.name == "position").fractions()
    theta = rest[0, 0] * rational(-position[1][0].numerator, position[1][0].denominator)
    assert theta * rational(stiffness_of(stiffness)) == rational(3, 10)


def stiffness_of(text):
    return rational(Fraction(text).numerator, Fraction(text).denominator)


@pytest.mark.parametrize(
    ("controllers", "decay", "verdict"),
    [
        # Without decay the position mode keeps the integral for ever.
        (BOTH, 0, "refuted"),
        ({"insertion": INSERTION, **BOTH}, 20, "proved"),
    ],
)
def test_what_becomes_of_the_integral_decides(controllers, decay, verdict):
    system = assembled(text_of(controllers, more=f"idle_states: {{decay: {decay} 1/s}}"))
    assert str(certify(system).verdict) == verdict


def test_alone_nothing_is_idle():
    system = assembled(text_of({"force": PI}))
    assert system.states == ("xp1", "xp2", "integral [rad]")
    assert str(certify(system).verdict) == "proved"


def test_the_run_in_single_precision_leaves_no_error():
    """What rounding leaves of the error is below what a sample adds to the integral."""
    text = text_of(
        BOTH,
        scenario="command: {points: [[0 s, 4 deg/s], [3 s, 4 deg/s]]}, "
        "surfaces: [{environment: soft, at: 2 deg}], "
        "control: {threshold: {position: position, force: force, torque: 0.27 N*m}}",
        more=f"{IDLE}\nsampling: {{period: 2 ms, delay: 1}}\ncontact: kept\n",
    )
    run = simulated(text, engine="sampled")
    assert run.response["torque"][-1] == pytest.approx(0.3, abs=2e-6)
