"""What saturates, as columns and rows: the same loop as by hand, in every realization."""

from fractions import Fraction

import numpy as np
import pytest

from nrs_design.certificates.catalogue import catalogue_kind
from nrs_design.pipeline.runs import run_certification
from nrs_design.proof.bounds import rounded_down
from nrs_design.simulation.saturation import saturated_rates
from tests.loop.support import assembled, loaded
from tests.support import ROOT

TEXT = (ROOT / "docs/examples/saturating.nrs.yaml").read_text("utf-8")
KP, KD, V, U = 117359.4375, 2060.0, np.deg2rad(8), 2000.0
KM, TAU = 4.8417e-4, 0.0351
RANGED = TEXT.replace(
    "4.8417e-4 rad/s/rpm",
    "{nominal: 4.8417e-4 rad/s/rpm, range: [4.793283e-4 rad/s/rpm, 4.890117e-4 rad/s/rpm]}",
)
LARGEST = "initial_force: 0.5 N*m", "initial_force: largest"
LOADED = TEXT.replace("0.0351 s\n", "0.0351 s\n  load_inertia: 1.213 kg*m^2\n")


def by_hand(x, k, Mt, Bt, gain=KM, J=np.inf):
    """Rates of e, omega, vm (with Mt) and delta."""
    e, omega, *vm, delta = x
    force = k * max(delta, 0.0) if k else 0.0
    v = np.clip(-(vm[0] if Mt else force / Bt), -V, V)
    u = np.clip(KP * e + KD * (v - omega), -U, U)
    inner = [(force - Bt * vm[0]) / Mt] if Mt else []
    return np.array([v - omega, gain / TAU * u - omega / TAU - force / J, *inner, omega])


def random_states(n):
    scale = np.array([0.05, 2.0, 2.0, 0.1])[[0, 1, *([2] if n == 4 else []), 3]]
    states = np.random.default_rng(5).uniform(-1, 1, (40, n)) * scale
    states[:, -1] = np.abs(states[:, -1])
    return states


@pytest.mark.parametrize("inertia", [0.01, 0.0])
def test_the_canonical_form_moves_as_the_joint_does(inertia):
    """e and omega are forms of the canonical states; both saturations act as by hand."""
    text = TEXT if inertia else TEXT.replace("Mt: 0.01", "Mt: 0")
    system = assembled(text)
    wn2, wn1 = KM * KP / TAU, (1 + KM * KD) / TAU
    # xp1 = (omega - Kd Km/tau xp2) / (Kp Km/tau), and e = xp2 + (1/tau) xp1.
    M = np.array([[wn1 - KM * KD / TAU, 1.0], [wn2, KM * KD / TAU]])
    n = system.order
    T = np.eye(n)
    T[:2, :2] = M
    rates = saturated_rates(system)
    stiffness = {"min": 720.56 * 0.24**2, "max": 768.17 * 0.24**2}
    names = [m.name for m in (*system.modes, *system.contact.free)]
    cut = 0
    for x in random_states(n):
        found = rates(np.tile(np.linalg.solve(T, x), (len(names), 1)))
        for name, rate in zip(names, found, strict=True):
            k = 0.0 if "free" in name else stiffness[name[-3:]]
            Bt = 2.15 if name.startswith("insertion") else 1.04
            wanted = by_hand(x, k, inertia, Bt)
            assert T @ rate == pytest.approx(wanted, rel=1e-5, abs=1e-5)
            cut += abs(wanted[0] + x[1]) > 0.999 * V
    assert 0 < cut < 40 * len(names)


@pytest.mark.parametrize(("text", "J"), [(RANGED, np.inf), (LOADED, 1.213)])
def test_ranges_of_the_motor_and_its_load(text, J):
    system = assembled(text)
    assert system.states[:2] == ("e [rad]", "omega [rad/s]")
    rates, count = saturated_rates(system), len(system.modes)
    for x in random_states(4):
        found = rates(np.tile(x, (count + len(system.contact.free), 1)))[:count]
        for mode, rate in zip(system.modes, found, strict=True):
            share = {"Km-min": 0.99, "Km-max": 1.01}
            gain = next((s for part, s in share.items() if part in mode.name), 1.0)
            k = 768.17 * 0.24**2 if "k-max" in mode.name else 720.56 * 0.24**2
            Bt = 2.15 if mode.name.startswith("insertion") else 1.04
            wanted = by_hand(x, k, 0.01, Bt, KM * gain, J)
            assert rate == pytest.approx(wanted, rel=1e-5, abs=1e-5)


@pytest.mark.parametrize(
    "text",
    [
        pytest.param(TEXT.replace("Mt: 0.01", "Mt: 0"), id="static"),
        pytest.param(RANGED, marks=pytest.mark.slow, id="ranges"),
        pytest.param(LOADED, marks=pytest.mark.slow, id="load"),
        pytest.param(TEXT.replace("losable", "kept"), marks=pytest.mark.slow, id="kept"),
    ],
)
def test_a_region_is_found_for_each(text):
    certification = run_certification(loaded(text, LARGEST)).certification
    evidence = certification.statements[-1]
    assert evidence.kind == "saturated-ellipsoid"
    assert evidence.find_fault(certification.system) is None
    assert evidence.start_size > Fraction(1, 10)


def test_the_largest_force_of_the_example():
    """0.845 N m on the page, at the softest of the range."""
    evidence = run_certification(loaded(TEXT, LARGEST)).certification.statements[-1]
    assert float(evidence.start_size) == pytest.approx(0.8459, rel=1e-3)
    assert rounded_down(evidence.start_size, "N*m").startswith("0.845")


def test_what_is_said_of_a_start_and_of_its_assumptions():
    system = assembled(TEXT)
    # The name of an assumption must not contradict what is proved of saturation.
    (kind,) = {k.name for k in map(catalogue_kind, system.assumptions) if "sampling" in k.name}
    assert kind == "no sampling or friction, and saturation only as stated"
    assert system.saturation.start.wanted == Fraction(1, 2)
    assert assembled(TEXT, ("goals:\n  initial_force: 0.5 N*m\n", "")).saturation is None
    lowest = min(float(x.floats()[-1][0]) for x in system.saturation.start.states)
    assert lowest == pytest.approx(1 / (768.17 * 0.24**2))
