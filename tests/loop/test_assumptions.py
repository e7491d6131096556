"""What a statement takes for granted, and what its words cover."""

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from nrs_design.certificates.catalogue import sentences
from nrs_design.controllers.float32 import exact_decimal
from nrs_design.controllers.sensor import LowPass, Sensor
from nrs_design.loop.assemble import assemble
from nrs_design.models.contact import HuntCrossley
from nrs_design.models.motion_loop import realize
from nrs_design.pipeline.runs import run_certification, run_design
from nrs_design.spec import parse_spec, read_spec
from nrs_design.spec.build_plant import build_plant
from tests.loop.support import assembled, loaded
from tests.support import ROBOT, SOFT_TISSUE, words_of
from tests.tables import cases_of, edited, spec_text

CONCHA = ROBOT / "concha.nrs.yaml"
LOW, HIGH, ABOUT = 0.1, 0.3, 0.2


@pytest.mark.parametrize("case", cases_of(Path(__file__).with_suffix(".yaml"), "base"))
def test_what_is_taken_for_granted(case):
    text = edited(spec_text(case["base"]), case.get("edit", []))
    system = assembled(text, more=f"\n{case.get('more', '')}\n")
    said = " ".join(words_of(system))
    assert [words for words in case["says"] if words not in said] == []
    assert [words for words in case.get("never", []) if words in said] == []
    assert "lost" not in case or (system.contact is not None) is case["lost"]


@pytest.fixture(scope="module")
def proved():
    result = run_certification(read_spec(CONCHA))
    assert result.certification.verdict == "proved"
    return result


def test_what_the_range_of_a_motor_holds_is_assumed():
    text = (ROBOT / "soft-tissue.nrs.yaml").read_text()
    gain = "gain: {nominal: 4.8e-4 rad/s/rpm, range: [4.7e-4 rad/s/rpm, 4.9e-4 rad/s/rpm]}"
    text = text.replace("gain: 4.8417e-4 rad/s/rpm", f"{gain}\n  range_covers: prediction")
    said = "The range of the actuator was identified to hold the next record with 95 % probability"
    known = f"range_covers: prediction\n  range_id: {parse_spec(text).actuator.values_id()}"
    for edit, end in (
        ((), ", unless it has been changed by hand since."),
        ((("range_covers: prediction", known),), "."),
    ):
        assert said + end in words_of(assembled(text, *edit))


def hunt_crossley(rng):
    """Any law within the ranges of the spec."""
    k, b, phi = rng.uniform(0.825, 1.009), rng.uniform(1.98, 2.42), rng.uniform(1.1, 1.3)
    return HuntCrossley(k / phi / ABOUT ** (phi - 1), b / ABOUT**phi, phi)


class Loop:
    """The loop around a nonlinear law, at a command that lets every controller rest there."""

    def __init__(self, result, law, rest):
        plant, design = result.designed.plant, result.design
        motion = realize(plant.motion_loop(design.motion.Kp, design.motion.Kd))
        self.A, self.C = np.array(motion.A, float), np.array(motion.C, float)
        self.gains = [
            (float(c.law.gains["Mt"]), float(c.law.gains["Bt"])) for c in design.controllers
        ]
        self.law, self.rest = law, rest

    def force(self, delta, velocity):
        return (self.law.rho + self.law.lam * velocity) * delta**self.law.phi

    def rate(self, x, controller):
        """x' of [xp1, xp2, vm, delta], all but xp counted from the rest."""
        Mt, Bt = self.gains[controller]
        delta, velocity = x[3] + self.rest, self.C @ x[:2]
        force = self.force(delta, velocity) - self.force(self.rest, 0.0)
        xp = self.A @ x[:2]
        xp[1] -= x[2]
        return np.array([*xp, (force - Bt * x[2]) / Mt, velocity])


def lyapunov(result):
    evidence = result.certification.evidence
    return np.array(evidence.nodes[0].form, dtype=float), float(
        evidence.proved_rate(result.certification.system)
    )


def test_power_law_decays_about_any_rest_however_far_and_fast(proved):
    """V' <= -2 alpha V at any state whose deflection is in the preload, with any law and rest."""
    Q, rate = lyapunov(proved)
    rng = np.random.default_rng(7)
    worst = -np.inf
    for _ in range(4000):
        rest = rng.choice([0.0, rng.uniform(0, HIGH)])
        loop = Loop(proved, hunt_crossley(rng), rest)
        scale = 10.0 ** rng.uniform(-4, 4, size=3)
        x = np.array([*(rng.normal(size=3) * scale), rng.uniform(LOW, HIGH) - rest])
        for controller in (0, 1):
            slope = 2 * x @ Q @ loop.rate(x, controller)
            worst = max(worst, slope / (x @ Q @ x) + 2 * rate)
    assert worst <= 1e-9


@pytest.mark.parametrize(("scale", "covered"), [("1/2", False), ("1", True), ("11/10", True)])
def test_ranges_scaled_below_one_do_not_cover_the_law(scale, covered):
    loaded = read_spec(CONCHA)
    designed = run_design(loaded)
    system = assemble(loaded.spec, designed.plant, designed.design, Fraction(scale))
    texts = " ".join(words_of(system))
    assert ("motions need not be small" in texts) is covered
    assert ("that law is not covered" in texts) is not covered


def test_contact_is_kept_by_default_where_there_is_a_preload():
    text = CONCHA.read_text().replace("contact: kept\n", "")
    spec = parse_spec(text)
    design = run_design(read_spec(CONCHA)).design
    assert assemble(spec, build_plant(spec), design).contact is None


SENSOR = Sensor({"bias": Fraction(1, 3), "drift": Fraction(1, 2)}, LowPass(2, Fraction(200)))


def test_without_a_sensor_nothing_is_said():
    assert not list(Sensor().assumptions(None, disturbed=False))


def test_errors_are_summed_rounded_up_and_left_out():
    filtered, errors = sentences(SENSOR.assumptions(None, disturbed=False))
    assert "2 equal lags in a row, x' = w (F - x) with w = 200 rad/s" in filtered
    assert "at most 0.833334 N*m (rounded up) (bias: 0.333334 N*m (rounded up); " in errors
    assert "drift: 0.5 N*m)" in errors
    assert "The statement leaves it out" in errors


def test_bounds_on_disturbances_take_them_up():
    step, errors = sentences(SENSOR.assumptions(Fraction(1, 500), disturbed=True))
    assert "x+ = p x + q F with the single-precision numbers p = 0.67" in step
    assert "It is the force error of the statements that name one" in errors


def sensed(more):
    """Design soft tissue in contact that is kept, with what is sampled and sensed."""
    found = run_design(loaded(SOFT_TISSUE, more=f"contact: kept\n{more}"))
    return found, assemble(found.spec, found.plant, found.design)


def test_the_filter_runs_with_the_outer_loop():
    sampling = "sampling: {period: 2 ms, outer_period: 0.5 ms, delay: 0}\n"
    found, system = sensed(f"{sampling}sensor: {{filter: {{cutoff: 60 Hz}}}}\n")
    step = found.design.sensor.filter.discretize(Fraction(1, 2000))
    (text,) = (text for text in words_of(system) if "through one lag" in text)
    assert f"p = {exact_decimal(step.p)} and" in text
    kept = {mode.A.fractions()[5][5] for mode in system.modes}
    assert kept == {step.p}


def test_the_sampled_loop_takes_the_errors_for_its_force_error():
    _, system = sensed(
        "sampling: {period: 2 ms, delay: 0}\ndisturbances: {encoder_step: 1e-5 rad}\n"
        "sensor: {bias: 5e-3 N*m, filter: {cutoff: 60 Hz}}\n"
    )
    assert system.states[4] == "filtered 1 before [N*m]"
    bounds = {channel.name: channel.bound for channel in system.channels}
    assert bounds["force error"] == Fraction("0.005")
