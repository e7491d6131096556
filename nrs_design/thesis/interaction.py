"""The thesis's robot in contact, simulated: what the rows and the figures of chapter 6 share."""

from __future__ import annotations

import math
from pathlib import Path

from nrs_design.pipeline.runs import run_design
from nrs_design.pipeline.scenarios import Runs, run_scenarios
from nrs_design.proof.text import exact_text
from nrs_design.simulation.run import Run
from nrs_design.spec import LoadedSpec, parse_spec
from nrs_design.thesis import thesis

# Desired impedance in N m s/rad, thesis 6.2.
DESIRED = thesis.TORQUE / thesis.VELOCITY
POSITION = "{type: position}"
_GAIN = f"environment: soft, proportional_gain: {exact_text(thesis.FORCE_GAIN)} rad/(N*m)"
PROPORTIONAL = f"{{type: force, {_GAIN}}}"
PROPORTIONAL_FROM_MEASURED = f"{{type: force, {_GAIN}, offset: measured}}"
INTEGRAL = f"{{type: pi-force, {_GAIN}, integral_gain: 0.5 rad/(N*m*s)}}"
BLEEDING = "idle_states: {decay: 20 1/s}"
# Kinds of control, as scenarios have them.
BY_SIGN = "{sign: {insertion: insertion, withdrawal: withdrawal}}"
BY_THRESHOLD = f"{{threshold: {{position: position, force: force, torque: {thesis.TORQUE} N*m}}}}"
# The profile of figure 6.7: seconds and deg/s. The print gives its shape and the largest speed.
PROFILE = ((0, 0), (1, 8), (2, 2), (3, 8), (4, 0), (5, -8), (6, -8), (7, 0))


def interaction(controllers: dict[str, str], scenario: str, more: str = "") -> str:
    """Return a spec of the thesis's robot with one scenario, ``run``; all parts are YAML."""
    numbers = {
        "gain": thesis.ACTUATOR.gain,
        "tau": thesis.ACTUATOR.time_constant,
        "Kd": thesis.DERIVATIVE_GAIN,
        "zero": thesis.ZERO,
        "soft": thesis.SOFT,
        "stiff": thesis.STIFF,
    }
    at = {name: exact_text(number) for name, number in numbers.items()}
    lines = "\n".join(f"  {name}: {text}" for name, text in controllers.items())
    return f"""\
kind: interaction-design
name: runs
actuator: {{gain: {at["gain"]} rad/s/rpm, time_constant: {at["tau"]} s}}
motion_loop: {{damping_ratio: {thesis.DAMPING_RATIO}, settling_time: {thesis.SETTLING_TIME} s,
  derivative_gain: {at["Kd"]} rpm*s/rad, zero: {at["zero"]} 1/s}}
limits: {{velocity: 8 deg/s, torque: {thesis.TORQUE} N*m, bandwidth: 2 Hz}}
environments:
  soft: {{model: elastic, stiffness: {at["soft"]} N*m/rad}}
  stiff: {{model: elastic, stiffness: {at["stiff"]} N*m/rad}}
controllers:
{lines}
switching: arbitrary
scenarios: {{run: {{{scenario}}}}}
{more}
"""


def run_scenario(controllers: dict[str, str], scenario: str, more: str = "") -> Run:
    """Simulate it with the exact engine."""
    text = interaction(controllers, scenario, more)
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


def withdrawals(speed: float) -> tuple[Run, Run]:
    """Simulate 6.3.2.3: in at 8 deg/s until the torque is at rest, and out, at a speed in deg/s.

    The first run is without switching.
    """
    both = {"insertion": admittance("0.01", "2.15"), "withdrawal": admittance("0.01", "1.04")}
    command = ((0, 8), (1, 8), (1, -speed), (2, -speed))
    without, switched = (
        run_scenario(both, into(0.5, *command, control=control))
        for control in ("{fixed: insertion}", BY_SIGN)
    )
    return without, switched


def two_contacts(soft: float, stiff: float, *pairs: tuple[float, float]) -> Run:
    """Simulate 6.4.2: soft tissue on one side, the tool on the other, a controller for each.

    They begin at angles in deg; the command is in s and deg/s.
    """
    return run_scenario(
        {"tissue": admittance("0.01", "2.15"), "tool": admittance("0.01", "2.11", "stiff")},
        f"command: {{{points(*pairs)}}}, surfaces: [{{environment: soft, at: {soft} deg}}, "
        f"{{environment: stiff, at: {stiff} deg, side: below}}], "
        "control: {contact: {soft: tissue, stiff: tool}}",
    )


def tissue_and_tool() -> Run:
    """Simulate 6.4: into soft tissue, out, onto the tool on the other side, and off it."""
    there_and_back = ((6, -8), (7, -2), (8, -8), (9, 0), (10, 8), (11, 0))
    return two_contacts(8, -2, *PROFILE[:6], *there_and_back)


def away(speed: float) -> float:
    """Return in how many s the deflection by the largest torque is passed, at a speed in deg/s."""
    return math.degrees(thesis.TORQUE / float(thesis.SOFT)) / speed
