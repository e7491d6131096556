"""The sampled engine against closed forms, an integrator and the exact engine."""

import math

import numpy as np
import pytest
from scipy.linalg import expm

from nrs_design.controllers.step_logic import StepLogic
from nrs_design.errors import DesignError
from nrs_design.spec import parse_spec
from tests.simulation.interactions import IMPEDANCE, PLACED, SAMPLED, simulated, text_of
from tests.tables import spec_text

RUN = (
    "command: {points: [[0 s, 0 deg/s], [0.3 s, 8 deg/s], [0.6 s, 2 deg/s], [1 s, -6 deg/s]]}, "
    "surfaces: [{environment: soft, at: 1 deg}]"
)


def sampled(scenario=RUN, more=SAMPLED, **options):
    return simulated(text_of(scenario=scenario, more=more, **options), "sampled")


@pytest.mark.parametrize(
    ("controllers", "other"), [(IMPEDANCE, "withdrawal"), ({**IMPEDANCE, **PLACED}, "position")]
)
def test_shorter_samples_come_to_continuous_time(controllers, other):
    """To first order in the period."""
    fine = RUN + f", control: {{schedule: [[0 s, insertion], [0.7 s, {other}]]}}"
    idle = "idle_states: {decay: 20 1/s}\n" * (other == "position")
    exact = simulated(text_of(controllers, scenario=fine, more=idle)).response
    errors = []
    for period in ("2 ms", "1 ms", "0.5 ms"):
        more = f"{idle}sampling: {{period: {period}, delay: 0}}\n"
        response = sampled(fine, more, controllers=controllers).response
        wanted = np.interp(response.t, exact.t, exact["angle"])
        errors.append(float(np.abs(response["angle"] - wanted).max()))
    assert errors[0] < 1e-3
    assert errors[1] < 0.6 * errors[0]
    assert errors[2] < 0.6 * errors[1]


def test_a_run_is_that_of_its_seed():
    noisy = RUN + ", errors: {force_noise: 0.02 N*m, jitter: 0.2}, seed: "
    one, same, other = (sampled(noisy + seed).response for seed in "778")
    assert np.array_equal(one.y, same.y)
    assert not np.array_equal(one.y, other.y)
    assert (np.diff(one.t) > 0).all()


def test_an_environment_that_remembers_is_as_in_continuous_time():
    solid = (
        "{model: kelvin-boltzmann, parallel_stiffness: 60 N*m/rad, series_stiffness: 80 N*m/rad, "
        "damping: 5 N*m*s/rad}"
    )
    fine = RUN + ", control: {fixed: insertion}"
    exact = simulated(text_of(scenario=fine, environments={"soft": solid})).response
    spec = text_of(scenario=fine, environments={"soft": solid})
    response = simulated(spec, "sampled", sampling=("0.2 ms", 0)).response
    wanted = np.interp(response.t, exact.t, exact["torque"])
    assert response["torque"] == pytest.approx(wanted, abs=3e-3)
    assert wanted.max() > 0.1


def test_noise_makes_a_logic_without_bands_chatter():
    """The signs of the thesis, with a command near zero; the count is told."""
    slow = (
        "command: {points: [[0 s, 4 deg/s], [1 s, 4 deg/s], [1 s, -0.1 deg/s], [3 s, -0.1 deg/s]]}"
        ", surfaces: [{environment: soft, at: 1 deg}], errors: {force_noise: 0.05 N*m}"
    )
    assert sampled(slow).chatter > 3
    assert sampled(slow.partition(", errors")[0]).chatter == 0


def test_a_command_that_samples_cannot_show_is_refused():
    swing = "command: {sinusoid: {amplitude: 1 deg/s, frequency: HZ}}, duration: 0.1 s"
    with pytest.raises(
        DesignError, match=r"250 Hz swings faster than samples of 0\.002 s"
    ) as found:
        sampled(swing.replace("HZ", "250 Hz"))
    assert found.value.at == ("scenarios", "run", "command", "sinusoid", "frequency")
    assert sampled(swing.replace("HZ", "249 Hz")).stopped is None


def test_without_a_period_or_a_motor_nothing_runs():
    text = text_of(scenario=RUN)
    with pytest.raises(DesignError, match="how often the law runs"):
        simulated(text, "sampled")
    given_loop = "\n  transfer_function: {numerator: [1], denominator: [1, 1]}"
    text = text.replace("  zero: 56.9706 1/s", f"  zero: 56.9706 1/s{given_loop}")
    with pytest.raises(DesignError, match="no motor to simulate"):
        simulated(text, "sampled", sampling=("2 ms", 0))


def two_clocks(period, outer, delay, duration):
    """The two loops as docs/certificates/timing.md has them, in double."""
    Km, tau, Kd, zero, k, at = 4.8417e-4, 0.0351, 2060.0, 56.9706, 43.0, np.radians(1)
    h = min(period, outer)
    step = expm(h * np.array([[0, 1, 0], [0, -1 / tau, Km / tau], [0, 0, 0]]))
    a = math.exp(-2.15 * outer / 0.01)
    b = (1 - a) / 2.15
    theta = omega = reference = velocity = before = command = 0.0
    samples, rows = [0.0] * (delay + 1), []
    for n in range(round(duration / h) + 1):
        t = n * h
        rows.append(theta)
        wanted = np.radians(np.interp(t, [0, 0.3, 0.6, 1], [0, 8, 2, -6]))
        if n % round(period / h) == 0:
            error = reference - theta
            command = Kd * zero * error + Kd * (error - before) / period
            before = error
        if n % round(outer / h) == 0:
            samples = [max(0.0, k * (theta - at)), *samples[:-1]]
            reference += outer * (wanted - velocity)
            velocity = a * velocity + b * samples[delay]
        theta, omega, _ = step @ [theta, omega, command]
    return np.array(rows)


@pytest.mark.parametrize(("period", "outer", "delay"), [("2 ms", "0.1 ms", 1), ("1 ms", "4 ms", 1)])
def test_two_periods(period, outer, delay):
    """Thesis 4.3: 2 ms and 0.1 ms. The peer has its own law, its own clocks and motor."""
    both = f"sampling: {{period: {period}, outer_period: {outer}, delay: {delay}}}\n"
    steady = RUN.replace("[1 s, -6 deg/s]", "[0.8 s, -2 deg/s]") + ", control: {fixed: insertion}"
    run = sampled(steady, both)
    first, second = (float(text.split()[0]) * 1e-3 for text in (period, outer))
    wanted = two_clocks(first, second, delay, 0.8)
    assert len(run.response) == len(wanted)
    assert run.response["angle"].max() > np.radians(1.1)
    # Single precision: some units in the last place of the reference, summed over its steps.
    assert np.abs(run.response["angle"] - wanted).max() < 1e-6
    alone = sampled(steady, f"sampling: {{period: {period}, delay: {delay}}}\n").response
    both = np.interp(alone.t, run.response.t, run.response["angle"])
    assert np.abs(both - alone["angle"]).max() > 1e-5


def test_a_budget_ends_a_run():
    run = simulated(text_of(scenario=RUN, more=SAMPLED), "sampled", max_steps=20)
    assert len(run.response) == 20
    assert "budget" in run.stopped


LOGIC = spec_text("logic-with-timer")


def test_the_timer_counts_samples_as_the_exported_logic_does():
    """100 ms are 50 samples of 2 ms, although 50 differences of their times add up to less."""
    shaken = (
        "command: {sinusoid: {amplitude: 8 deg/s, frequency: 2 Hz}}, duration: 4 s, "
        "surfaces: [{environment: soft, at: 0.1 deg}]"
    )
    text = text_of(PLACED, scenario=shaken, more=SAMPLED.replace("delay: 1", "delay: 0") + LOGIC)
    spec = parse_spec(text)
    run = simulated(text, "sampled")
    response = run.response
    logic = StepLogic.create(spec.mode_logic, response.modes, spec.sampling.period.exact)
    mode, held, modes = logic.start, 0, []
    for command, torque in zip(response["hand"], response["torque"], strict=True):
        signals = {"command": np.float32(command), "torque": np.float32(torque)}
        mode, held = logic.step(mode, held, signals)
        modes.append(mode)
    assert len(run.switches) > 8
    assert modes == response.mode.tolist()


POWER = (
    "{model: hunt-crossley, stiffness: 43 N*m/rad, damping: 0.1 N*m*s/rad, exponent: 1.2, "
    "about: 0.01 rad, preload: [0.005 rad, 0.02 rad]}"
)
ERRORS = "{friction: 120 rpm, encoder_step: 0.01 deg, force_noise: 0.01 N*m, jitter: 0.3}"


@pytest.mark.parametrize("law", [POWER, "{model: elastic, stiffness: 43 N*m/rad}"])
def test_a_loaded_motor_with_friction_moves_as_small_steps_say(law):
    """The mechanics alone, recomputed from the recorded commands and instants."""
    text = text_of(
        environments={"soft": law}, scenario=f"{RUN}, errors: {ERRORS}", more="contact: kept\n"
    ).replace("0.0351 s}", "0.0351 s, load_inertia: 1.213 kg*m^2}")
    text = text.replace("2 Hz}", "2 Hz, command: 280 rpm}")
    run = simulated(text, "sampled", sampling=("2 ms", 1))
    response = run.response
    assert run.saturated == (np.abs(response["command"]) == 280).sum() > 10
    assert np.abs(response["command"]).max() == 280
    late = response.t / 0.002 - np.arange(len(response))
    assert 0 <= late.min() < 0.02
    assert 0.28 < late.max() <= 0.3

    Km, tau, J, friction, at = 4.8417e-4, 0.0351, 1.213, 120.0, np.radians(1)
    rho, lam = 43 / (1.2 * 0.01**0.2), 0.1 / 0.01**1.2

    def push(theta, omega):
        depth = theta - at
        if depth <= 0:
            return 0.0
        force = (rho + lam * omega) * depth**1.2 if law == POWER else 43 * depth
        return max(0.0, force)

    theta = omega = 0.0
    angles, stuck = [], 0
    for k, command in enumerate(response["command"][:-1].tolist()):
        angles.append(theta)
        h = (response.t[k + 1] - response.t[k]) / 100
        for _ in range(100):
            pull = Km * command / tau - push(theta, omega) / J - omega / tau
            dry = Km * friction / tau
            free = omega + h * pull
            new = math.copysign(max(0.0, abs(free) - h * dry), free)
            stuck += new == 0.0
            theta, omega = theta + h * (omega + new) / 2, new
    assert stuck > 100
    assert np.abs(response["torque"]).max() > 0.05
    # Steps of 20 us, explicit: some 1e-5 s times the largest velocity, 0.14 rad/s.
    assert np.abs(response["angle"][:-1] - angles).max() < 2e-5


def test_the_law_gets_coarse_angles_and_noisy_torques():
    """Recomputed in single precision from the recorded states, bit for bit."""
    text = text_of(scenario=f"{RUN}, errors: {ERRORS}, control: {{fixed: insertion}}", more=SAMPLED)
    response = simulated(text, "sampled").response
    step = np.radians(0.01)
    angle = (np.round(response["angle"] / step) * step).astype(np.float32)
    assert (angle != response["angle"].astype(np.float32)).mean() > 0.9
    f = np.float32
    error = response["reference"].astype(f) - angle
    Kp, D = f(2060 * 56.9706), f(2060 / 0.002)
    command = Kp * error + D * (error - response["error before"].astype(f))
    assert np.array_equal(command.astype(float), response["command"])
    # v+ = a v + b f: from the velocities of the law follow the torques that it took.
    vm = response["state velocity"]
    a = math.exp(-2.15 * 0.002 / 0.01)
    noise = (vm[2:] - a * vm[1:-1]) / ((1 - a) / 2.15) - response["torque"][:-2]
    assert noise.std() == pytest.approx(0.01, rel=0.1)
    assert abs(noise.mean()) < 0.002


def test_a_threshold_is_compared_as_the_program_does():
    """The single-precision number nearest to 0.64 is below it, and the threshold one above.

    The force sensor reads in steps of 0.64 N*m: compared as doubles, one would switch.
    """
    logic = LOGIC.replace("0.27 N*m", "0.64 N*m")
    text = text_of(
        PLACED,
        scenario="command: {points: [[0 s, 4 deg/s], [DURATION, 4 deg/s]]}, "
        "surfaces: [{environment: soft, at: 2 deg}], errors: {force_step: 0.64 N*m}",
        more=SAMPLED + logic,
    )
    for duration, largest, switches in (("0.8 s", 0.96, 0), ("1.2 s", 2.0, 1)):
        run = simulated(text.replace("DURATION", duration), "sampled")
        torque = run.response["torque"]
        assert 0.64 < torque.max() < largest
        assert len(run.switches) == switches
    ((moment, _),) = run.switches
    # Where 1.28 N*m is the nearest step.
    reached = torque[np.searchsorted(run.response.t, moment)]
    assert reached == pytest.approx(0.96, abs=0.02)
