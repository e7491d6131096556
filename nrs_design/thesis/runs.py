"""Chapters 6 and 7, simulated: what the model says of the experiments on the robot.

In chapter 7 a hand moves the robot through 15 deg with the admittances of table 7.1. The thesis
drives the endoscope with a motor and a handle, and prints neither its torque nor its speed. Two
operators stand for it: a hand that pushes with the torque limit of 6.3.1 whatever happens, and one
that moves on with the largest speed of 6.3.1 behind a stiffness of its own, that of surgeons' hands
as cited in 6.1. They are ends between which an operator is, and no fits.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

import numpy as np

from nrs_design.models.motion_loop import realize
from nrs_design.pipeline.runs import run_design
from nrs_design.pipeline.scenarios import Runs, run_scenarios
from nrs_design.proof.text import exact_text
from nrs_design.simulation import metrics
from nrs_design.simulation.metrics import Effort, effort
from nrs_design.simulation.run import Run
from nrs_design.simulation.time_response import Array
from nrs_design.spec import LoadedSpec, parse_spec
from nrs_design.thesis import thesis
from nrs_design.thesis.comparison import Recomputed, Result
from nrs_design.thesis.loops import ADMITTANCES

POSITION = "{type: position}"
_GAIN = f"environment: soft, proportional_gain: {exact_text(thesis.FORCE_GAIN)} rad/(N*m)"
PROPORTIONAL = f"{{type: force, {_GAIN}}}"
PROPORTIONAL_FROM_MEASURED = f"{{type: force, {_GAIN}, offset: measured}}"
INTEGRAL = f"{{type: pi-force, {_GAIN}, integral_gain: 0.5 rad/(N*m*s)}}"
BLEEDING = "idle_states: {decay: 20 1/s}"
# Kinds of control, as scenarios have them.
SIGN_YAML = "{sign: {insertion: insertion, withdrawal: withdrawal}}"
THRESHOLD_YAML = f"{{threshold: {{position: position, force: force, torque: {thesis.TORQUE} N*m}}}}"
# The profile of figure 6.7: seconds and deg/s. The print gives its shape and the largest speed.
PROFILE = ((0, 0), (1, 8), (2, 2), (3, 8), (4, 0), (5, -8), (6, -8), (7, 0))


def interaction(controllers: dict[str, str], scenario: str, extra: str = "") -> str:
    """Return a spec of the thesis's robot with one scenario, ``run``; all parts are YAML."""
    numbers = {
        "gain": thesis.ACTUATOR.gain,
        "tau": thesis.ACTUATOR.time_constant,
        "Kd": thesis.DERIVATIVE_GAIN,
        "zero": thesis.ZERO,
        "soft": thesis.SOFT,
        "stiff": thesis.STIFF,
    }
    texts = {name: exact_text(number) for name, number in numbers.items()}
    lines = "\n".join(f"  {name}: {text}" for name, text in controllers.items())
    return f"""\
kind: interaction-design
name: runs
actuator: {{gain: {texts["gain"]} rad/s/rpm, time_constant: {texts["tau"]} s}}
motion_loop: {{damping_ratio: {thesis.DAMPING_RATIO}, settling_time: {thesis.SETTLING_TIME} s,
  derivative_gain: {texts["Kd"]} rpm*s/rad, zero: {texts["zero"]} 1/s}}
limits: {{velocity: 8 deg/s, torque: {thesis.TORQUE} N*m, bandwidth: 2 Hz}}
environments:
  soft: {{model: elastic, stiffness: {texts["soft"]} N*m/rad}}
  stiff: {{model: elastic, stiffness: {texts["stiff"]} N*m/rad}}
controllers:
{lines}
switching: arbitrary
scenarios: {{run: {{{scenario}}}}}
{extra}
"""


def run_scenario(controllers: dict[str, str], scenario: str, extra: str = "") -> Run:
    """Simulate it with the exact engine."""
    text = interaction(controllers, scenario, extra)
    designed = run_design(
        LoadedSpec(path=Path("runs.nrs.yaml"), sha256="", text=text, spec=parse_spec(text))
    )
    assert designed is not None
    (found,) = run_scenarios(designed, Runs(engine="exact"))
    return found.run


def admittance(Mt: str, Bt: str, environment: str = "soft") -> str:
    """Return an impedance controller as YAML; Mt in kg m^2 and Bt in N m s/rad."""
    return f"{{type: impedance, environment: {environment}, Mt: {Mt} kg*m^2, Bt: {Bt} N*m*s/rad}}"


def points(*pairs: tuple[float, float]) -> str:
    """Return a command through points of s and deg/s, as YAML."""
    return "points: [" + ", ".join(f"[{t} s, {v} deg/s]" for t, v in pairs) + "]"


def into(tissue: float, *pairs: tuple[float, float], control: str = "") -> str:
    """Return a scenario as YAML: a command in s and deg/s, and soft tissue from an angle in deg on.

    `control` says who is in control when; the first controller by default.
    """
    begin = f"command: {{{points(*pairs)}}}, surfaces: [{{environment: soft, at: {tissue} deg}}]"
    return f"{begin}, control: {control}" if control else begin


def simulated_runs() -> Iterator[Result]:
    """Simulate insertion and withdrawal, the limit on the force, and tissue and tool."""
    yield from _profile()
    for speed in (5, 3):
        before, after = (_withdrawal(speed, c) for c in ("{fixed: insertion}", SIGN_YAML))
        gain = 100 * (1 - after / before)
        # Time in s to pass the deflection under the largest torque.
        escape_time = math.degrees(thesis.TORQUE / float(thesis.SOFT)) / speed
        yield Recomputed((before, after, gain), gain > 0, (f"{escape_time:.2f}",))
    yield _peak_and_error(PROPORTIONAL)
    yield _peak_and_error(PROPORTIONAL_FROM_MEASURED)
    yield _peak_and_error(INTEGRAL, BLEEDING)
    yield _tissue_and_tool()


def _profile() -> Iterator[Recomputed]:
    """Yield peaks on the command of figure 6.7, and the displayed impedance."""
    scenario = into(8, *PROFILE)
    stiff = run_scenario({"position": POSITION}, scenario)
    run = run_scenario({"insertion": admittance("0", "2.15")}, scenario)
    peaks = tuple(float(np.abs(r.response["torque"]).max()) for r in (stiff, run))
    yield Recomputed(peaks, peaks[0] > thesis.TORQUE > peaks[1])
    constant = into(1, (0, 4), (2, 4))
    settled = run_scenario({"insertion": admittance("0", "2.15")}, constant).response
    impedance, _ = metrics.displayed_impedance(settled["hand"], settled["torque"])
    hand, torque = run.response["hand"], run.response["torque"]
    error = metrics.impedance_rmse(run.response.t, hand, torque, thesis.DESIRED)
    yield Recomputed((float(impedance[-1]), error or math.nan))


def _withdrawal(speed: float, control: str) -> float:
    """Simulate 6.3.2.3: in at 8 deg/s until the torque is at rest, and out; return the time in s.

    The speed out is in deg/s; control says, as YAML, which controller acts when.
    """
    laws = {"insertion": admittance("0.01", "2.15"), "withdrawal": admittance("0.01", "1.04")}
    command = ((0, 8), (1, 8), (1, -speed), (2, -speed))
    found = run_scenario(laws, into(0.5, *command, control=control)).response
    (time,) = metrics.withdrawal_times(found.t, found["hand"], found["torque"])
    return time


def _peak_and_error(force: str, extra: str = "") -> tuple[float, float]:
    """Return the peak torque in N m and the steady error in % of force control."""
    scenario = into(1, (0, 5), (2, 5), control=THRESHOLD_YAML)
    run = run_scenario({"position": POSITION, "force": force}, scenario, extra)
    ((begin, _),) = run.switches
    force_phase = run.response.t >= begin
    t, torque = run.response.t[force_phase], run.response["torque"][force_phase]
    peak = thesis.TORQUE * (1 + metrics.overshoot(torque, thesis.TORQUE))
    # Rounding removes the remainder of a decay from the steady error.
    return peak, round(100 * metrics.steady_state_error(t, torque, thesis.TORQUE), 6)


def _tissue_and_tool() -> Recomputed:
    """Simulate 6.4: into soft tissue, out, onto the tool on the other side, and off it."""
    there_and_back = ((6, -8), (7, -2), (8, -8), (9, 0), (10, 8), (11, 0))
    run = run_scenario(
        {"tissue": admittance("0.01", "2.15"), "tool": admittance("0.01", "2.11", "stiff")},
        f"command: {{{points(*PROFILE[:6], *there_and_back)}}}, "
        "surfaces: [{environment: soft, at: 8 deg}, "
        "{environment: stiff, at: -2 deg, side: below}], "
        "control: {contact: {soft: tissue, stiff: tool}}",
    )
    t, hand, torque = run.response.t, run.response["hand"], run.response["torque"]
    parts: tuple[Array, Array] = np.maximum(torque, 0.0), np.minimum(torque, 0.0)
    errors = tuple(
        metrics.impedance_rmse(t, hand, part, thesis.DESIRED) or math.nan for part in parts
    )
    peaks = tuple(float(np.abs(part).max()) for part in parts)
    return Recomputed((*errors, *peaks), [name for _, name in run.switches] == ["tool"])


# Thesis 7.2.2: phi goes from 0 to -15 deg; and 6.1: 1002 N/m, at the lever arm of 0.24 m.
WAY = math.radians(15)
HAND = float(Fraction(1002) * Fraction("0.24") ** 2)
_STEP = 1e-3
# Pairs of compared experiments by index; printed changes of speed and of applied torque in %.
PAIRS = ((0, 1), (1, 2), (3, 4), (4, 5), (0, 3), (1, 4), (2, 5))
SPEEDS = (-6, -5, -2, -2, -35, -33, -30)
TORQUES = (4, 7, 1, 0, 97, 92, 79)


@dataclass(frozen=True, slots=True, eq=False)
class HandRun:
    """What one move shows, until the way is made."""

    time: float  # How long the way takes, s
    effort: Effort  # Effort of the hand
    last: float  # Velocity of the admittance at the end, rad/s


def move(Mt: float, Bt: float, stiffness: float | None = None) -> HandRun:
    """Simulate ``Mt vm' + Bt vm = F`` above the motion loop until the way is made.

    The hand pushes with `thesis.TORQUE`; with a stiffness in N m/rad, it moves on at
    `thesis.VELOCITY`.
    """
    from scipy.linalg import expm

    motion = realize(thesis.CLOSED_LOOP)
    Ap, C = np.array(motion.A, float), np.array(motion.C, float)
    n = len(C)
    # States after the motion loop: velocity of the admittance, angle, way of the hand, one.
    velocity, angle, hand, one = range(n, n + 4)
    F, A = np.zeros(n + 4), np.zeros((n + 4, n + 4))
    if stiffness is None:
        F[one] = thesis.TORQUE
    else:
        F[hand], F[angle] = stiffness, -stiffness
    A[:n, :n], A[n - 1, velocity] = Ap, 1.0
    A[velocity] = F / Mt
    A[velocity, velocity] -= Bt / Mt
    A[angle, :n], A[hand, one] = C, thesis.VELOCITY
    step, states = expm(_STEP * A), [np.eye(n + 4)[one]]
    while states[-1][angle] < WAY:
        states.append(step @ states[-1])
    before, after = states[-2], states[-1]
    share = (WAY - before[angle]) / (after[angle] - before[angle])
    states[-1] = before + share * (after - before)
    z = np.array(states)
    t = _STEP * np.arange(len(z), dtype=float)
    t[-1] = t[-2] + share * _STEP
    return HandRun(float(t[-1]), effort(t, z @ F, z[:, :n] @ C), float(z[-1, velocity]))


def changes(values: list[float]) -> tuple[float, ...]:
    """Return the difference of each pair of `PAIRS`, in % of the first."""
    return tuple(100 * (values[after] / values[before] - 1) for before, after in PAIRS)


def hand_runs() -> Iterator[Recomputed]:
    """Simulate the six experiments with both operators."""
    pushed = [move(*admittance) for admittance in ADMITTANCES]
    led = [move(*admittance, HAND) for admittance in ADMITTANCES]
    slow, fast = (changes([WAY / run.time for run in runs]) for runs in (pushed, led))
    is_near = all(abs(slow[i] - SPEEDS[i]) < 1 for i in range(4))
    yield Recomputed(slow, is_near and all(value < 0 for value in slow))
    triples = zip(fast[4:], SPEEDS[4:], slow[4:], strict=True)
    yield Recomputed(fast, all(led > printed > pushed for led, printed, pushed in triples))
    low, high = (changes([run.effort.total for run in runs]) for runs in (pushed, led))
    pairs = zip(low, TORQUES, strict=True)
    yield Recomputed(low, all(value > 0 and abs(value - printed) < 12 for value, printed in pairs))
    yield Recomputed(high, all(value > 0 for value in high))
    found = [run.effort for run in pushed]
    energies = [e.energy for e in found]
    numbers = (*(e.total for e in found), max(e.rms for e in found), max(energies))
    yield Recomputed(numbers, max(energies) - min(energies) < 1e-3)
