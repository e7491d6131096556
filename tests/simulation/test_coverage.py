"""No run of a certified spec leaves its bound; and whether a bound is about a run."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nrs_design.pipeline.runs import run_certification
from nrs_design.pipeline.scenarios import Runs, hold_bounds, hold_rate, run_scenarios
from nrs_design.search.certification import Limits
from nrs_design.simulation.coverage import Coverage
from nrs_design.simulation.exact import simulate_exactly
from nrs_design.simulation.sampled import simulate_sampled
from nrs_design.simulation.scenario import Control, Errors, Profile
from nrs_design.spec import parse_spec, read_spec
from nrs_design.spec.sampling import DisturbancesSpec
from tests.simulation.interactions import text_of
from tests.support import spec_in

LAWS = {
    "insertion": "{type: impedance, environment: soft, Mt: 0 kg*m^2, Bt: 2.15 N*m*s/rad}",
    "withdrawal": "{type: impedance, environment: soft, Mt: 0 kg*m^2, Bt: 1.06 N*m*s/rad}",
}
RUN = (
    "command: {sinusoid: {amplitude: 8 deg/s, frequency: 2 Hz}}, duration: 1 s, "
    "surfaces: [{environment: soft, at: 0 deg}]"
)
BOUNDED = "contact: losable\ndisturbances: {command: 8 deg/s}\n"


@pytest.fixture(scope="module")
def certified(tmp_path_factory):
    path = spec_in(tmp_path_factory.mktemp("spec"), text_of(LAWS, scenario=RUN, more=BOUNDED))
    return run_certification(read_spec(path), limits=Limits(optimize_rate=False))


def bounds(certified, simulated):
    found = hold_bounds(certified.designed, certified.certificate, simulated)
    return {bound.output: bound for bound in found}


@settings(max_examples=12)
@given(
    velocities=st.lists(st.sampled_from([-8.0, 8.0, 3.0]), min_size=2, max_size=12),
    stay=st.floats(0.02, 0.2),
    turns=st.lists(st.booleans(), min_size=12, max_size=12),
)
def test_no_run_leaves_its_bound(certified, velocities, stay, turns):
    """Jumps of the command and of the controller, at any of the instants."""
    designed = certified.designed
    (usual,) = run_scenarios(designed)
    times = np.repeat(stay * np.arange(len(velocities) + 1), 2)[1:-1]
    profile = Profile.through(times, np.radians(np.repeat(velocities, 2)))
    names = ["withdrawal" if turn else "insertion" for turn in turns]
    schedule = tuple((stay * (i + 0.5), name) for i, name in enumerate(names))
    scenario = replace(
        usual.scenario,
        profile=profile,
        duration=stay * len(velocities),
        control=Control("insertion", schedule=schedule),
    )
    run = simulate_exactly(designed.spec, designed.plant, designed.design, scenario)
    found = bounds(certified, replace(usual, scenario=scenario, run=run))
    assert not found["force"].uncovered
    assert np.abs(run.response["torque"]).max() <= found["force"].level
    assert np.abs(run.response["velocity"]).max() <= found["velocity"].level


@pytest.fixture(scope="module")
def sampled(tmp_path_factory):
    """One controller, every 2 ms, with the roundings of single precision."""
    more = BOUNDED.replace("8 deg/s", "8 deg/s, largest_angle: 1 rad")
    more = f"{more}sampling: {{period: 2 ms, delay: 0}}\n"
    text = text_of({"insertion": LAWS["insertion"]}, scenario=RUN, more=more)
    path = spec_in(tmp_path_factory.mktemp("spec"), text)
    return run_certification(read_spec(path), limits=Limits(optimize_rate=False))


@pytest.mark.slow
@settings(max_examples=8)
@given(st.lists(st.sampled_from([-8.0, 8.0, 5.0]), min_size=2, max_size=10), st.floats(0.02, 0.2))
def test_no_run_of_the_law_that_ships_leaves_its_bound(sampled, velocities, stay):
    designed = sampled.designed
    (usual,) = run_scenarios(designed)
    times = np.repeat(stay * np.arange(len(velocities) + 1), 2)[1:-1]
    profile = Profile.through(times, np.radians(np.repeat(velocities, 2)))
    scenario = replace(usual.scenario, profile=profile, duration=stay * len(velocities))
    run = simulate_sampled(designed.spec, designed.plant, designed.design, scenario)
    found = bounds(sampled, replace(usual, scenario=scenario, run=run))
    assert not found["force"].uncovered
    assert np.abs(run.response["torque"]).max() <= found["force"].level
    (faster,) = run_scenarios(designed, Runs(period=0.001))
    assert any("period" in reason for reason in bounds(sampled, faster)["force"].uncovered)


def scenario_with(**changes):
    return lambda one: replace(one, scenario=replace(one.scenario, **changes))


def run_with(**changes):
    return lambda one: replace(one, run=replace(one.run, **changes))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda one: one, []),
        (scenario_with(errors=Errors(force_noise=0.1)), ["noise"]),
        (scenario_with(errors=Errors(jitter=0.1)), ["late"]),
        (scenario_with(errors=Errors(force_step=1)), ["force error"]),
        (scenario_with(errors=Errors(friction=1.0)), ["the friction exceeds", "change its sign"]),
        # No proof knows saturation, nor samples that the law refuses.
        (run_with(saturated=1), ["met its limit"]),
        (run_with(refused=1), ["refused samples"]),
        # Its peak lies between two instants, perhaps: 8 deg/s is the bound of the proof.
        (
            scenario_with(profile=Profile.sinusoid(np.radians(8) * (1 + 1e-7), 12.0)),
            ["the velocity command exceeds the bound of the proof"],
        ),
        (
            lambda one: scenario_with(surfaces=one.scenario.surfaces * 2)(one),
            ["there are several surfaces, and the proof is about one"],
        ),
    ],
)
def test_what_a_proof_does_not_take_up_is_said(certified, change, said):
    (one,) = run_scenarios(certified.designed)
    reasons = bounds(certified, change(one))["force"].uncovered
    assert len(reasons) == len(said)
    assert all(word in reason for word, reason in zip(said, reasons, strict=True))


def test_another_engine_than_that_of_the_proof(certified):
    (one,) = run_scenarios(certified.designed, Runs(engine="sampled"))
    for bound in bounds(certified, one).values():
        assert any("not about the sampled loop" in reason for reason in bound.uncovered)


def test_contact_that_a_proof_takes_for_kept(certified):
    """A run begins in free motion, also where there is no surface at all."""
    designed, system = certified.designed, certified.certificate.system
    (one,) = run_scenarios(designed)
    alone = replace(one.scenario, surfaces=())
    statement = next(s for s in certified.certificate.statements if s.bound(system))
    for kept in (replace(system, contact=None), system):
        reasons = [*Coverage(designed.spec, kept, statement, alone, one.run).uncovered()]
        assert reasons == [
            "the run makes or loses contact, and the proof assumes constant contact"
        ] * (kept.contact is None)


ENDING = "command: {points: [[0 s, 6 deg/s], [0.5 s, 6 deg/s], [0.5 s, 0 deg/s], [3 s, 0 deg/s]]}, "
PRESSED = ENDING + "surfaces: [{environment: soft, at: 1 deg}], control: {fixed: withdrawal}"


@pytest.fixture(scope="module")
def ending(tmp_path_factory):
    text = text_of(LAWS, scenario=PRESSED, more="contact: losable\n")
    return run_certification(read_spec(spec_in(tmp_path_factory.mktemp("spec"), text)))


def test_once_nothing_is_commanded_a_run_decays_as_certified(ending):
    designed = ending.designed
    (one,) = run_scenarios(designed)
    held = hold_rate(designed, ending.certificate, one)
    assert (held.uncovered, held.start, held.unit) == ((), 0.5, "1/s")
    after = one.run.response.t > held.start
    t, torque = one.run.response.t[after], np.abs(one.run.response["torque"][after])
    assert torque[0] > 0.05
    # In the long run no slower: from some time on, below any multiple of the exponential.
    assert held.rate > 0.5
    scaled = torque * np.exp(held.rate * (t - held.start))
    assert scaled[-1] < 0.1 * scaled[0]


@pytest.mark.parametrize(
    ("change", "options", "reason"),
    [
        (lambda s: replace(s, profile=Profile.constant(0.05)), {}, "does not come to an end"),
        (lambda s: replace(s, profile=Profile.sinusoid(0.05, 2.0)), {}, "does not come to an end"),
        (lambda s: replace(s, duration=0.5), {}, "does not come to an end"),
        (lambda s: replace(s, errors=Errors(friction=1.0)), {}, "go on acting"),
        (lambda s: replace(s, surfaces=s.surfaces * 2), {}, "several surfaces"),
        (lambda s: s, {"engine": "sampled"}, "not about the sampled loop"),
        (lambda s: s, {"engine": "sampled"}, "the rounding of angle and reference goes on acting"),
    ],
)
def test_when_a_rate_is_not_about_a_run(ending, change, options, reason):
    designed = ending.designed
    (one,) = run_scenarios(designed, Runs(**options))
    changed = replace(one, scenario=change(one.scenario))
    held = hold_rate(designed, ending.certificate, changed)
    assert any(reason in text for text in held.uncovered)


@pytest.mark.parametrize(("share", "said"), [(0.5, True), (1.0, False)])
def test_the_reference_counts_among_the_angles(certified, share, said):
    """While the axis moves, the reference leads it: the law holds both in single precision."""
    designed, system = certified.designed, certified.certificate.system
    scenario = text_of(LAWS, scenario="command: {constant: 8 deg/s}, duration: 0.2 s")
    (one,) = run_scenarios(replace(designed, spec=parse_spec(scenario)), Runs(engine="sampled"))
    angle, reference = (float(np.abs(one.run.response[n]).max()) for n in ("angle", "reference"))
    assert reference > 1.05 * angle
    limit = f"{angle + share * (reference - angle)!r} rad"
    given = DisturbancesSpec.model_validate({"command": "8 deg/s", "largest_angle": limit})
    spec = designed.spec.model_copy(update={"disturbances": given})
    statement = next(s for s in certified.certificate.statements if s.bound(system))
    reasons = [*Coverage(spec, system, statement, one.scenario, one.run).uncovered()]
    assert ("the angle exceeds the bound of the proof" in reasons) == said


@pytest.mark.parametrize(
    ("rules", "said"),
    [("{transitions: [[insertion, withdrawal]]}", False), ("{longest_dwell_time: 0.2 s}", True)],
)
def test_one_controller_all_the_time_is_not_left_in_time(certified, rules, said):
    """A proof with a longest dwell time may be about a mode that is unstable by itself."""
    system = certified.certificate.system
    spec = parse_spec(text_of(LAWS).replace("switching: arbitrary", f"switching: {rules}"))
    (one,) = run_scenarios(certified.designed)
    stays = replace(one.scenario, control=Control("insertion"))
    statement = next(s for s in certified.certificate.statements if s.bound(system))
    reasons = [*Coverage(spec, system, statement, stays, one.run).uncovered()]
    assert reasons == ["nothing makes the run keep the rules of switching"] * said


@pytest.mark.slow
def test_two_clocks_are_not_one(sampled):
    """The step of both is the same, and the law is another."""
    (one,) = run_scenarios(sampled.designed)
    assert not any(
        "period" in reason for b in bounds(sampled, one).values() for reason in b.uncovered
    )
    other = replace(one, run=replace(one.run, outer=0.004))
    for bound in bounds(sampled, other).values():
        assert any("period" in reason for reason in bound.uncovered)
