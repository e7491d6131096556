"""What saturates in a sampled loop: as the law in single precision, motor and tissue move."""

from fractions import Fraction
from functools import cache

import numpy as np
import pytest
from scipy.linalg import expm

from nrs_design.controllers.replica import StepProgram
from nrs_design.controllers.shipped import shipped_law
from nrs_design.pipeline.certification import assemble_spec
from nrs_design.pipeline.runs import run_design
from nrs_design.search.acceptance import first_accepted
from nrs_design.search.saturated_ellipsoid import search_saturated
from nrs_design.search.work import Allowance
from nrs_design.simulation.norms import clipped, quadratic_norm
from nrs_design.simulation.saturation import saturated_rates
from tests.loop.support import loaded
from tests.proof.systems import pushed_away_in_steps
from tests.support import ROOT, words_of
from tests.tables import entry

KM, TAU, PERIOD = 4.8417e-4, 0.0351, Fraction(1, 500)
SAMPLED = "switching: arbitrary\nsampling: {period: 2 ms, delay: 1}"
IMPEDANCE = (
    (ROOT / "docs/examples/saturating.nrs.yaml")
    .read_text("utf-8")
    .replace("switching: arbitrary", SAMPLED)
    .replace("initial_force: 0.5 N*m", "initial_force: largest")
)
RANGES = entry(__file__, "ranges")
FORCE = (ROOT / "specs/neuroboscope/force-limit-pi-sampled.nrs.yaml").read_text("utf-8")
for old, new in RANGES.items():
    FORCE = FORCE.replace(old, new)
FORCE += "anti_windup: {clamp: 0.1 deg}\n"
TEXTS = {"impedance": IMPEDANCE, "force": FORCE}
SOFTEST, HARDEST = 720.56 * 0.24**2, 768.17 * 0.24**2


@cache
def loop(kind):
    """Return the system, the law that ships, and the region of a kind of controllers."""
    spec = loaded(TEXTS[kind])
    designed = run_design(spec)
    system = assemble_spec(spec, designed)
    law = shipped_law(spec.spec, designed.design, PERIOD)
    evidence, _ = first_accepted(search_saturated(system, Allowance()), system)
    return system, law, evidence


class Robot:
    """The law in single precision on motor and tissue, from a state of the system."""

    def __init__(self, kind):
        self.system, self.law, _ = loop(kind)
        self.program = StepProgram(self.law)
        self.flow = expm(np.array([[0, 1, 0], [0, -1 / TAU, KM / TAU], [0, 0, 0]]) * float(PERIOD))
        self.stored = {v.name: v.stored for v in self.law.states if v.stored}

    def step(self, x, controller, k, late):
        """Return the state after a sample, and whether command or integral were cut off."""
        known = dict(zip(self.system.states, x, strict=True))
        delta, force = known["delta [rad]"], k * max(known["delta [rad]"], 0.0)
        given = {"angle": delta, "torque": known["F 1 before [N*m]"] if late else force}
        held = {name: known.get(text, 0.0) for name, text in self.stored.items()}
        if "e [rad]" in known:
            held["reference"] = known["e [rad]"] + delta
        values = [np.float32((given | held).get(value.name, 0.0)) for value in self.law.values]
        (command,), states, valid = self.program.step(self.law.modes.index(controller), values)
        assert valid
        angle, omega, _ = self.flow @ [delta, known["omega [rad/s]"], float(command)]
        after = dict(
            zip((value.name for value in self.law.states), map(float, states), strict=True)
        )
        found = {text: after[name] for name, text in self.stored.items()}
        found |= {"omega [rad/s]": omega, "delta [rad]": angle, "F 1 before [N*m]": force}
        found |= {"e [rad]": after["reference"] - angle} if "e [rad]" in known else {}
        limits = {name: float(c.values[0]) for name, c in self.law.coefficient.items()}
        cut = (
            abs(command) >= limits["command_limit"],
            ("integral" in after and abs(after["integral"]) >= limits["integral_limit"]),
        )
        return np.array([found[name] for name in self.system.states]), cut


def ways(system):
    """Yield every mode in contact with the controller, stiffness and age that it stands for."""
    for k, mode in enumerate(system.modes):
        parts = mode.name.split("/")
        if parts[-1] != "flow-0":
            continue
        stiffness = {"k-min": SOFTEST, "k-max": HARDEST}.get(parts[-2])
        late = "delay-0" not in parts
        if stiffness is None:
            # What touches nothing, or takes no force.
            stiffness = 0.0
        yield k, parts[0], stiffness, late


@pytest.mark.parametrize("kind", TEXTS)
def test_a_sample_of_the_law_is_a_step_of_the_system(kind):
    """From random states, most of them beyond the limits of the signals."""
    robot = Robot(kind)
    system, steps = robot.system, saturated_rates(robot.system)
    scale = {"omega [rad/s]": 1.0, "vm [rad/s]": 0.5, "F 1 before [N*m]": 2.0}
    sizes = np.array([scale.get(name, 0.02) for name in system.states])
    rng, cut = np.random.default_rng(7), []
    for _ in range(30):
        x = np.float32(rng.uniform(-1, 1, system.order) * sizes).astype(float)
        x[-1] = abs(x[-1])
        every = len(system.modes) + len(system.free)
        after = steps(np.tile(x, (every, 1)))
        for k, controller, stiffness, late in ways(system):
            found, limited = robot.step(x, controller, stiffness, late)
            assert found == pytest.approx(after[k], rel=3e-4, abs=3e-5)
            cut.append(limited)
    commands, integrals = np.mean(cut, axis=0)
    assert 0.2 < commands < 1
    assert (integrals > 0.2) == (kind == "force")


@pytest.mark.parametrize("kind", TEXTS)
def test_no_run_in_single_precision_leaves_the_region(kind):
    """From the edge in many directions; at every sample what makes V largest, in contact or not."""
    robot, (system, _, evidence) = Robot(kind), loop(kind)
    assert evidence.covers_rounding
    Q = np.ldexp(np.array(evidence.Q, dtype=float), -evidence.denominator_log2)
    norm = quadratic_norm(Q) if system.contact is None else clipped(quadratic_norm(Q))
    rng, choices = np.random.default_rng(5), list(ways(system))
    starts = [np.array(x.floats())[:, 0] for x in system.saturation.start.states[:2]]
    spread = np.linalg.inv(np.linalg.cholesky(Q)).T
    starts += [spread @ rng.normal(size=system.order) for _ in range(10)]
    # Where the command is largest in the region.
    row = np.array(system.saturation.signals[0].rows[-1].floats())[0]
    starts.append(np.linalg.solve(Q, row[: system.order]))
    limited = 0
    for x in starts:
        x = x * np.sign(x[-1] or 1.0)
        x = x / norm(x[None])[0]
        for sample in range(1, 60):
            moved = [robot.step(x, *choice[1:]) for choice in choices]
            worst = int(norm(np.array([after for after, _ in moved])).argmax())
            x, cut = moved[worst]
            limited += cut[0]
            value = norm(x[None])[0]
            assert value <= float(evidence.rate) ** sample * (1 + 1e-5)
    assert limited > 0


def test_the_region_of_a_scalar_loop_is_nearly_that_of_its_motions():
    """By hand: x+ = 3/2 x + sat(-x) decays from |x| < 2, and from no other x."""
    system = pushed_away_in_steps()
    evidence, words = first_accepted(search_saturated(system, Allowance()), system)
    assert words == "found"
    assert 1.9 < evidence.level < 2
    steps = saturated_rates(system)
    for start, grows in ((1.99, False), (2.01, True)):
        x = np.array([[start]])
        for _ in range(50):
            x = steps(x)
        assert (abs(x[0, 0]) > start) == grows


def test_what_is_taken_for_granted():
    for kind, words in (("impedance", "2000 rpm, or at any"), ("force", "the integral of the")):
        system, _, _ = loop(kind)
        assert words in words_of(system)[-1]
        assert "saturation only where a statement says so" in " ".join(words_of(system))
        assert "friction and saturation are not" not in " ".join(words_of(system))
