"""The exact engine against closed forms, and against an integrator that knows nothing of it."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from nrs_design.design.analysis import design_controllers
from nrs_design.errors import DesignError
from nrs_design.loop.assemble import assemble
from nrs_design.simulation.build_scenario import build_scenario, default_scenario
from nrs_design.simulation.exact import simulate_exactly
from nrs_design.simulation.loop import Loop
from nrs_design.simulation.scenario import Condition, Control, Switch
from nrs_design.spec import parse_spec
from nrs_design.spec.build_plant import build_plant
from tests.simulation.interactions import (
    FORCE,
    IMPEDANCE,
    INSERTION,
    PLACED,
    SAMPLED,
    SOFT,
    simulated,
    text_of,
)

KM, TAU, KD = 4.8417e-4, 0.0351, 2060.0
KP = KD * 56.9706
BT, MT = float(np.float32(2.15)), float(np.float32(0.01))
FREE = "command: {constant: 4 deg/s}, duration: 1 s"


def test_free_motion_is_the_step_response_of_the_motion_loop():
    """``theta = v (t - T)`` in the end, and on the way the ramp response of G, thesis 6.1."""
    response = simulated(text_of(scenario=FREE)).response
    s = np.roots([TAU, 1 + KD * KM, KP * KM])
    v = np.radians(4)
    # v G(s)/s^2 in partial fractions: G is 1 at zero, and has a zero at -Kp/Kd and poles p, q.
    wanted = v * response.t
    for p, q in (s, s[::-1]):
        residue = (KD * KM * p + KP * KM) / TAU / (p - q)
        wanted = wanted + v * (residue / p**2 * (np.exp(p * response.t) - 1)).real
    assert response["angle"] == pytest.approx(wanted, abs=2e-9)
    assert not response["torque"].any()


def reference(times, v, k, c, Bt, Mt, surface, sign, load=np.inf):
    """Integrate the loop as it stands in the thesis: error, velocity, admittance, angle."""

    def force(omega, theta):
        depth = sign * (theta - surface)
        return sign * max(0.0, k * depth + c * sign * omega) if depth > 0 else 0.0

    def rates(t, y):
        e, omega, vm, theta = y
        F = force(omega, theta)
        slip = v(t) - vm - omega
        turn = (KM * (KP * e + KD * slip) - omega) / TAU - F / load
        return [slip, turn, (F - Bt * vm) / Mt, omega]

    found = solve_ivp(
        rates, (0, times[-1]), np.zeros(4), "DOP853", times, rtol=1e-10, atol=1e-13, max_step=1e-3
    )
    omega, theta = found.y[1], found.y[3]
    return theta, np.array([force(w, a) for w, a in zip(omega, theta, strict=True)])


@pytest.mark.slow
@settings(max_examples=5)
@given(
    k=st.integers(5, 60),
    surface=st.integers(1, 20),
    swing=st.integers(2, 8),
    below=st.booleans(),
    damping=st.sampled_from([0.0, 0.25]),
)
def test_contact_is_as_an_integrator_finds_it(k, surface, swing, below, damping):
    """In and out of tissue on either side, with a sinusoid; the integrator takes small steps."""
    model = f"kelvin-voigt, damping: {damping} N*m*s/rad" if damping else "elastic"
    sign = -1 if below else 1
    at = sign * surface / 1000
    text = text_of(
        environments={"soft": f"{{model: {model}, stiffness: {k} N*m/rad}}"},
        scenario=f"command: {{sinusoid: {{amplitude: {swing} deg/s, frequency: 2 Hz}}}}, "
        f"duration: 0.5 s, control: {{fixed: insertion}}, surfaces: [{{environment: soft, "
        f"at: {at} rad, side: {'below' if below else 'above'}}}]",
    )
    response = simulated(text).response
    grid = np.linspace(0, 0.5, 201)
    theta, F = reference(
        grid, lambda t: np.radians(swing) * np.sin(4 * np.pi * t), k, damping, BT, MT, at, sign
    )
    near = np.minimum(np.searchsorted(response.t, grid - 1e-9), len(response) - 1)
    same = np.abs(response.t[near] - grid) < 1e-9
    assert same.sum() > 10
    assert response["angle"][near][same] == pytest.approx(theta[same], abs=2e-7)
    assert response["torque"][near][same] == pytest.approx(F[same], abs=2e-5)


def test_the_load_of_the_motor_is_felt():
    text = text_of(
        scenario="command: {constant: 4 deg/s}, duration: 1 s, control: {fixed: insertion}, "
        "surfaces: [{environment: soft, at: 1 deg}]"
    ).replace("0.0351 s}", "0.0351 s, load_inertia: 1.213 kg*m^2}")
    response = simulated(text).response
    v = np.radians(4)
    times = np.array([0.0, 0.5, 1.0])
    theta, F = reference(times, lambda t: v, 43, 0, BT, MT, np.radians(1), 1, load=1.213)
    assert response["angle"][-1] == pytest.approx(theta[-1], abs=2e-8)
    assert response["torque"][-1] == pytest.approx(F[-1], abs=2e-6)


def test_a_bounce_by_hand():
    """A loop without dynamics but one lag, on a spring, with Mt = 0: a quadratic in closed form.

    ``theta' = (r - theta)/T``, ``r' = v - k theta/B`` in contact from theta = 0: the angle is
    ``v B/k`` minus two modes, and contact is lost where the command turns back.
    """
    one = "{type: impedance, environment: soft, Mt: 0 kg*m^2, Bt: 2 N*m*s/rad}"
    text = text_of(
        {"one": one},
        {"soft": "{model: elastic, stiffness: 1 N*m/rad}"},
        "command: {constant: 1 deg/s}, duration: 3 s, surfaces: [{environment: soft, at: 0 deg}]",
    ).replace(
        "  zero: 56.9706 1/s",
        '  zero: 56.9706 1/s\n  transfer_function: {numerator: [1], denominator: ["1/10", 1]}',
    )
    response = simulated(text).response
    v, T, B, k = np.radians(1), 0.1, 2.0, 1.0
    a, b = np.roots([T, 1, k / B])
    # T theta'' + theta' + (k/B) theta = v, from rest.
    end = v * B / k
    wanted = end * (1 + (b * np.exp(a * response.t) - a * np.exp(b * response.t)) / (a - b))
    assert response["angle"] == pytest.approx(wanted, abs=1e-11)


@pytest.mark.parametrize(
    ("engine", "more", "within"), [("exact", "", 1e-6), ("sampled", SAMPLED, 1e-4)]
)
def test_position_and_force_control_end_where_the_balance_is(engine, more, within):
    """X held from the switch on: ``F = k (X - s + Kp (Fd - F))``, thesis 6.3.3."""
    text = text_of(
        PLACED,
        scenario="command: {points: [[0 s, 4 deg/s], [2 s, 4 deg/s]]}, "
        "surfaces: [{environment: soft, at: 2 deg}], "
        "control: {threshold: {position: position, force: force, torque: 0.27 N*m}}",
        more=more,
    )
    run = simulated(text, engine)
    ((moment, name),) = run.switches
    assert name == "force"
    k, Kp, v = 43.0, float(np.float32(0.02)), np.radians(4)
    reached = k * (v * moment - np.radians(2))
    wanted = (reached + Kp * k * 0.3) / (1 + Kp * k)
    assert run.response["torque"][-1] == pytest.approx(wanted, rel=within)


DAMPED = "{model: kelvin-voigt, stiffness: 43 N*m/rad, damping: 0.3 N*m*s/rad}"
CREEPING = (
    "{model: kelvin-boltzmann, parallel_stiffness: 60 N*m/rad, series_stiffness: 80 N*m/rad, "
    "damping: 5 N*m*s/rad}"
)
PI = FORCE.replace("{type: force", "{type: pi-force, integral_gain: 0.1 rad/(N*m*s)")
FILTER = "sensor: {filter: {cutoff: 30 Hz, order: 2}}\n"


@pytest.mark.parametrize("loaded", [False, True])
@pytest.mark.parametrize(
    ("tissue", "more"),
    [
        (SOFT, ""),
        (SOFT, FILTER),
        (DAMPED, ""),
        (DAMPED, FILTER),
        (CREEPING, ""),
        (CREEPING, FILTER),
    ],
)
def test_modes_have_the_poles_of_what_runs(tissue, more, loaded):
    """Of any law, contact and filter; beside them are what a run commands, and what is idle."""
    laws = {"insertion": INSERTION, **PLACED, "hold": PI}
    if (tissue, more) == (DAMPED, ""):
        # The command of a force controller would depend on itself at once.
        laws = {"insertion": INSERTION, "position": PLACED["position"]}
    text = text_of(laws, {"soft": tissue}, more=f"{more}idle_states: {{decay: 20 1/s}}\n")
    if loaded:
        text = text.replace("0.0351 s", "0.0351 s, load_inertia: 0.5 kg*m^2")
    spec = parse_spec(text)
    plant = build_plant(spec)
    design = design_controllers(spec, plant)
    loop = Loop(spec, plant, design, default_scenario(spec, plant))
    swing = 1j * loop.scenario.profile.omega
    for mode in assemble(spec, plant, design).modes:
        name, *touched = mode.name.split("/")
        left = [*np.linalg.eigvals(loop.mode(name, (0,) * len(touched)).A)]
        for pole in np.linalg.eigvals(np.array(mode.A.floats())):
            nearest = min(range(len(left)), key=lambda i: abs(left[i] - pole))
            assert abs(left.pop(nearest) - pole) < 1e-4 * max(1, abs(pole))
        assert all(min(abs(z - x) for x in (0, swing, -swing)) < 1e-4 for z in left)


def test_what_runs_without_an_offset_is_what_is_proved():
    """The motion under force control is that of the assembled mode, and X an input of it alone."""
    spec = parse_spec(text_of(PLACED, scenario=FREE))
    plant = build_plant(spec)
    design = design_controllers(spec, plant)
    scenario = build_scenario(spec, plant, "run", spec.scenarios["run"])
    touching = replace(scenario, surfaces=default_scenario(spec, plant).surfaces)
    loop = Loop(spec, plant, design, touching)
    proved = {mode.name: mode.A for mode in assemble(spec, plant, design).modes}
    for name, label in (("position", "position"), ("force", "force/soft")):
        own = np.array(proved[label].floats())
        A = loop.mode(name, (0,) if name == "force" else ()).A
        assert np.poly(A[:2, :2]) == pytest.approx(np.poly(own), rel=1e-9)
    place = [signal.name for signal in loop.states].index("commanded position")
    assert A[0, place] or A[1, place]
    assert not A[place].any()


def test_a_pi_leaves_no_error_and_its_integral_bleeds():
    """No matter where X waits: ``F = Fd`` in the end. Out again, the integral is ``exp(-20 t)``."""
    force = "{type: pi-force, environment: soft, proportional_gain: 0.02 rad/(N*m), "
    force += "integral_gain: 0.5 rad/(N*m*s)}"
    run = simulated(
        text_of(
            {"position": "{type: position}", "force": force},
            scenario="command: {points: [[0 s, 4 deg/s], [2.5 s, 4 deg/s], [2.5 s, -4 deg/s], "
            "[3 s, -4 deg/s]]}, surfaces: [{environment: soft, at: 2 deg}], "
            "control: {threshold: {position: position, force: force, torque: 0.27 N*m}}",
            more="idle_states: {decay: 20 1/s}",
        )
    )
    (entered, _), (left, _) = run.switches
    t, torque, integral = run.response.t, run.response["torque"], run.response["integral"]
    assert torque[t < left][-1] == pytest.approx(0.3, rel=1e-8)
    after = t >= left
    assert integral[after] == pytest.approx(
        integral[after][0] * np.exp(-20 * (t[after] - left)), rel=1e-9, abs=1e-15
    )
    assert not integral[t < entered].any()
    # It stays in the reference, so that the reference does not jump where no error is left.
    reference = run.response["reference"]
    before, behind = reference[t < left][-1], reference[after][0]
    assert behind == pytest.approx(before, abs=1e-8)


def test_insertion_and_withdrawal_change_by_sign():
    run = simulated(text_of())
    assert [name for _, name in run.switches] == ["withdrawal", "insertion"]
    (made, _, _), (lost, _, _) = run.contacts
    assert made < run.switches[0][0] < run.switches[1][0] == pytest.approx(lost, abs=1e-6)


def test_an_environment_that_remembers_relaxes():
    """A Maxwell element held at a depth: ``F = F0 exp(-k t/b)``."""
    text = text_of(
        PLACED,
        {"soft": "{model: maxwell, stiffness: 40 N*m/rad, damping: 20 N*m*s/rad}"},
        "command: {points: [[0 s, 8 deg/s], [0.1 s, 8 deg/s], [0.1 s, 0 deg/s], [2 s, 0 deg/s]]}, "
        "control: {fixed: position}, surfaces: [{environment: soft, at: 0.2 deg}]",
    ).replace(FORCE, "{type: position}")
    response = simulated(text).response
    late = response.t > 0.8
    first = response["torque"][late][0]
    decay = np.exp(-2 * (response.t[late] - response.t[late][0]))
    assert response["torque"][late] == pytest.approx(first * decay, rel=1e-6)


def test_layers_add_up_and_the_last_met_is_in_control():
    text = text_of(
        {"tissue": IMPEDANCE["insertion"], "tool": IMPEDANCE["insertion"]},
        {"soft": SOFT, "stiff": "{model: elastic, stiffness: 60 N*m/rad}"},
        "command: {sinusoid: {amplitude: 8 deg/s, frequency: 0.5 Hz}}, duration: 2 s, "
        "control: {contact: {soft: tissue, stiff: tool}}, surfaces: "
        "[{environment: soft, at: 1 deg}, {environment: stiff, at: 1.2 deg}]",
    )
    run = simulated(text)
    assert [name for _, name in run.switches] == ["tool", "tissue"]
    met = [(name, made) for _, name, made in run.contacts]
    assert met == [("soft", True), ("stiff", True), ("stiff", False), ("soft", False)]
    deep = run.response["depth"] > np.radians(0.2) + 1e-9
    depth = run.response["depth"][deep]
    both = 43 * depth + 60 * (depth - np.radians(0.2))
    assert run.response["torque"][deep] == pytest.approx(both, rel=1e-9)


def test_a_budget_ends_a_run():
    run = simulated(text_of(scenario=FREE), max_steps=10)
    assert "budget" in run.stopped
    assert run.response.t[-1] < 1


def test_a_budget_of_steps_is_one_of_events():
    """A command that changes its sign a thousand times in a run, and the logic with it."""
    text = text_of(
        scenario="command: {sinusoid: {amplitude: 1 deg/s, frequency: 500 Hz}}, duration: 1 s, "
        "control: {sign: {insertion: insertion, withdrawal: withdrawal}}"
    )
    run = simulated(text, max_steps=25_000)
    assert run.stopped is not None
    assert "101 events by 0.1" in run.stopped
    assert "one event in 250 of --max-steps" in run.stopped


def test_a_logic_that_asks_for_two_at_one_instant_is_stopped():
    spec = parse_spec(text_of(scenario=FREE))
    plant = build_plant(spec)
    scenario = build_scenario(spec, plant, "run", spec.scenarios["run"])
    out = (Condition("command", low=0.01),)
    both = (Switch("insertion", "withdrawal", out), Switch("withdrawal", "insertion", out))
    scenario = replace(scenario, control=Control("insertion", both))
    run = simulate_exactly(spec, plant, design_controllers(spec, plant), scenario)
    assert "chatters at 0 s" in run.stopped
    held = replace(
        scenario, control=Control("insertion", both, {"insertion": 0.1, "withdrawal": 0.2})
    )
    run = simulate_exactly(spec, plant, design_controllers(spec, plant), held)
    assert run.stopped is None
    assert [time for time, _ in run.switches] == pytest.approx([0.1, 0.3, 0.4, 0.6, 0.7, 0.9])
    assert run.shortest_stay == pytest.approx(0.1)


def test_a_schedule_switches_when_it_says():
    run = simulated(
        text_of(scenario=FREE + ", control: {schedule: [[0 s, insertion], [250 ms, withdrawal]]}")
    )
    assert run.switches == ((0.25, "withdrawal"),)
    assert run.response.mode[0] == 0
    assert run.response.mode[-1] == 1


def test_a_power_law_is_for_the_other_engine():
    text = text_of(
        environments={
            "soft": "{model: hunt-crossley, stiffness: 43 N*m/rad, damping: 0.1 N*m*s/rad, "
            "exponent: 1.2, about: 0.01 rad, preload: [0.005 rad, 0.02 rad]}"
        }
    )
    with pytest.raises(DesignError, match="is not linear") as caught:
        simulated(text)
    assert "--engine sampled" in caught.value.remedy
