"""10,000 runs against every bound: what is proved about the sampled loop, and what runs reach."""

from __future__ import annotations

from pathlib import Path
from time import perf_counter

import numpy as np

from benchmarks.measure import Finding, Size
from benchmarks.single_precision import Choices, simulate_single_precision
from nrs_design.certificates.bounds import bound_on
from nrs_design.controllers.controller_design import ControllerDesign
from nrs_design.controllers.step_law import StepFrame, build_law
from nrs_design.pipeline.certification import Overrides, search_limits
from nrs_design.pipeline.design import Designed
from nrs_design.pipeline.runs import run_certification
from nrs_design.proof.evidence.abstract import Bound
from nrs_design.proof.system import SwitchedSystem
from nrs_design.simulation.worst_case import worst_against
from nrs_design.spec import LoadedSpec, parse_spec

SPEC = Path(__file__).parents[1] / "specs" / "neuroboscope" / "soft-tissue-sampled.nrs.yaml"
RUNS, QUICK_RUNS, SMOKE_RUNS, STEPS, SEED = 10_000, 1000, 10, 500, 13
# Seconds for the search, on a machine that does other work besides.
BUDGET = 300.0
PERIOD, SPEED, LARGEST_ANGLE = 0.002, 8.0, 20.0
# Controllers, contact, and the least share of the bound that a run should reach.
CASES = (
    (("insertion",), "0.01", "kept", 0.6),
    (("insertion",), "0.01", "losable", 0.5),
    (("insertion", "withdrawal"), "0.01", "kept", 0.3),
    (("insertion", "withdrawal"), "0.01", "losable", 0.1),
    (("insertion", "withdrawal"), "0", "losable", 0.2),
)


def run(size: Size) -> tuple[Finding, ...]:
    """Simulate runs of every case in single precision, against the proved bound on the force."""
    runs = size.pick(RUNS, QUICK_RUNS, SMOKE_RUNS)
    return tuple(_finding(*case, runs) for case in size.pick(CASES, CASES, CASES[:1]))


def _finding(
    controllers: tuple[str, ...], inertia: str, contact: str, near: float, runs: int
) -> Finding:
    start = perf_counter()
    level, reached, rounded = hold_against_bound(controllers, inertia, contact, runs)
    inside = reached < level
    return Finding(
        f"{runs} runs of {STEPS} steps, {' and '.join(controllers)}, Mt {inertia}, {contact}",
        f"largest force {reached:.4g} N*m, proved {level:.4g} N*m, ratio {level / reached:.3g}"
        + ("" if rounded else ", without rounding"),
        f"none beyond the bound, one at {near:.0%} of it",
        inside and reached > near * level,
        perf_counter() - start,
    )


def hold_against_bound(
    controllers: tuple[str, ...], inertia: str, contact: str, runs: int
) -> tuple[float, float, bool]:
    """Return the proved bound, the largest force of all runs, and whether rounding is covered.

    `inertia` is Mt in kg m^2, `contact` ``kept`` or ``losable``, as proved and simulated.
    """
    loaded = _spec(controllers, inertia, contact)
    limits = search_limits(loaded.spec, Overrides(budget=BUDGET), optimize_rate=False)
    result = run_certification(loaded, limits=limits)
    system = result.certification.system
    found = bound_on(system, result.certification.statements, "force")
    assert found is not None
    assert result.designed is not None
    reached = _largest_force(result.designed, system, found, contact == "losable", runs)
    included = all(item.covers_rounding for item in result.certification.statements)
    return float(found.level), reached, included


def _spec(controllers: tuple[str, ...], inertia: str, contact: str) -> LoadedSpec:
    """Return the shipped spec with a motor that is known, a command and these controllers."""
    text = SPEC.read_text(encoding="utf-8")
    head, _, _ = text.partition("controllers:")
    damping = {"insertion": "2.15", "withdrawal": "1.04"}
    lines = "".join(
        f"  {name}: {{type: impedance, environment: soft, Mt: {inertia} kg*m^2, "
        f"Bt: {damping[name]} N*m*s/rad}}\n"
        for name in controllers
    )
    head = head.replace(
        "{nominal: 4.8417e-4 rad/s/rpm, range: [4.744866e-4 rad/s/rpm, 4.938534e-4 rad/s/rpm]}",
        "4.8417e-4 rad/s/rpm",
    ).replace("{nominal: 0.0351 s, range: [0.034398 s, 0.035802 s]}", "0.0351 s")
    whole = (
        f"{head}controllers:\n{lines}switching: arbitrary\ncontact: {contact}\n"
        "sampling: {period: 2 ms, delay: [0, 1]}\n"
        f"disturbances: {{command: {SPEED} deg/s, largest_angle: {LARGEST_ANGLE} deg}}\n"
    )
    return LoadedSpec(path="bounded-runs", sha256="", text=whole, spec=parse_spec(whole))


def _largest_force(
    designed: Designed,
    system: SwitchedSystem,
    found: Bound,
    losable: bool,
    runs: int,
) -> float:
    rng = np.random.default_rng(SEED)
    design: ControllerDesign = designed.design
    period = designed.spec.sampling.period.exact if designed.spec.sampling else None
    assert period is not None
    laws = {c.name: c.law.discretize(period, "exact") for c in design.controllers}
    whole = {name: law for name, law in laws.items() if law is not None}
    choices = _choices(designed, system, found, rng, runs)
    offset = rng.uniform(-1, 1, runs) * np.deg2rad(LARGEST_ANGLE) * 0.9
    frame = StepFrame(design.motion.Kp, design.motion.difference_gain(period))
    law = build_law(frame, whole)
    forces = simulate_single_precision(law, PERIOD, choices, offset, losable=losable)
    return float(np.abs(forces).max())


def _choices(
    designed: Designed,
    system: SwitchedSystem,
    found: Bound,
    rng: np.random.Generator,
    runs: int,
) -> Choices:
    """Return random choices, half of them those of an adversary with some changed."""
    count, shape = len(designed.design.controllers), (runs, STEPS)
    stiffness = designed.plant.environment("soft").stiffness
    low, high = float(stiffness.low), float(stiffness.high)
    held = np.arange(STEPS) // rng.integers(1, 80, (runs, 1))

    def blocks(values: np.ndarray) -> np.ndarray:
        return np.take_along_axis(values, held, axis=1)

    law = blocks(rng.integers(0, count, shape))
    delay = rng.integers(0, 2, shape)
    k = low + (high - low) * blocks(rng.choice([0.0, 0.5, 1.0], shape))
    command = blocks(rng.choice([-1.0, 1.0], shape))
    own_law, own_delay, own_k, own_command = _adversary(designed, system, found)
    steps, half = len(own_law), runs // 2
    span = slice(max(STEPS - steps, 0), STEPS)
    tail = slice(max(steps - STEPS, 0), steps)
    kept = rng.random((half, STEPS)) < np.sqrt(rng.random((half, 1)))
    kept[0] = True
    kept[:, : span.start] = False
    for mine, theirs in (
        (law, own_law),
        (delay, own_delay),
        (k, low + (high - low) * own_k),
        (command, own_command),
    ):
        wide = mine[:half].copy()
        wide[:, span] = theirs[tail]
        mine[:half] = np.where(kept, wide, mine[:half])
    command[0, : span.start] = 0.0
    speed = np.deg2rad(SPEED)
    return Choices(
        law, delay, k, np.full(shape, 4.8417e-4), np.full(shape, 0.0351), speed * command
    )


def _adversary(designed: Designed, system: SwitchedSystem, found: Bound) -> tuple[np.ndarray, ...]:
    """Return what an adversary of the linear model does: law, delay, end of k, sign of command."""
    run = worst_against(system, found)
    free = () if system.contact is None else system.contact.free
    names = [mode.name.split("/") for mode in (*system.modes, *free)]
    controllers = [c.name for c in designed.design.controllers]
    chosen = [names[index] for index in run.mode]
    law = np.array([controllers.index(parts[0]) for parts in chosen])
    delay = np.array([int("delay-1" in parts) for parts in chosen])
    k = np.array([float("k-max" in parts) for parts in chosen])
    return law, delay, k, np.sign(run.disturbances[:, 0])
