"""The worst runs that are found, against closed forms, an engine of another kind, and bounds."""

import math
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

from nrs_design.pipeline.runs import run_certification, run_design
from nrs_design.pipeline.scenarios import run_scenarios, run_worst_case
from nrs_design.proof.channels import Channel, Output
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.switching import ARBITRARY, Clock, Reset, Stay, Switching
from nrs_design.search.certification import Limits
from nrs_design.simulation.exact import simulate_exactly
from nrs_design.simulation.rules import Rules
from nrs_design.simulation.scenario import Control, Profile, Scenario, Surface
from nrs_design.simulation.worst_case import worst_runs
from nrs_design.spec import parse_spec
from nrs_design.spec.load import LoadedSpec
from tests.proof.systems import family, matrix
from tests.simulation.interactions import text_of
from tests.tables import spec_text


def oscillator(*stiffness, damping="1", switching=ARBITRARY):
    """Return ``x'' + c x' + k x = d`` with |d| <= 1, and x as what is watched."""
    rows = ([[0, 1], [f"-{k}", f"-{damping}"]] for k in stiffness)
    columns = (matrix([[0], [1]]),) * len(stiffness)
    return replace(
        family(*rows, switching=switching, names=[f"k-{k}" for k in stiffness]),
        channels=(Channel("push", "N", Fraction(1), columns),),
        outputs=(Output("x", "m", (matrix([[1, 0]]),)),),
    )


def found(system):
    (run,) = worst_runs(system, system.outputs)
    return run


@pytest.mark.parametrize("damping", ["1", "0.5"])
def test_one_stiffness(damping):
    """The push changes sign with the velocity: ``coth(pi zeta / (2 sqrt(1 - zeta^2))) / k``."""
    k, c = 4.0, float(damping)
    zeta = c / (2 * math.sqrt(k))
    exact = 1 / math.tanh(math.pi * zeta / (2 * math.sqrt(1 - zeta**2))) / k
    run = found(oscillator("4", damping=damping))
    assert run.value <= exact * (1 + 1e-12)
    assert run.value == pytest.approx(exact, rel=0.03)
    v, push = run.states[:-1, 1], run.disturbances[:, 0]
    moving = np.abs(v) > 0.1 * np.abs(v).max()
    late = np.arange(len(v)) > len(v) // 2
    assert (np.sign(push) == np.sign(v))[moving & late].mean() > 0.97


def swing(k, c, start, speed):
    """Return x and v over time of ``x'' + c x' + k x = 1``."""
    w, rest = math.sqrt(k - c * c / 4), 1 / k
    a, b = start - rest, (speed + c / 2 * (start - rest)) / w

    def at(t):
        decay, s, o = math.exp(-c / 2 * t), math.sin(w * t), math.cos(w * t)
        x = rest + decay * (a * o + b * s)
        v = decay * (-c / 2 * (a * o + b * s) + w * (b * o - a * s))
        return x, v

    return at, math.pi / w


def farthest(low, high, c):
    """Return where the bang-bang run comes to: soft on the way out, stiff on the way back.

    On the boundary of what can be reached from rest the gradient is at right angles to the motion,
    so its entry that k and d act through has the sign of v: d = sign v, and k is low where x v is
    positive. Half a round from -X at rest comes to X at rest.
    """

    def next_peak(X):
        back, half = swing(high, c, -X, 0.0)
        through = brentq(lambda t: back(t)[0], 0, half)
        out, half = swing(low, c, 0.0, back(through)[1])
        turn = brentq(lambda t: out(t)[1], 1e-9, half)
        return out(turn)[0]

    return brentq(lambda X: next_peak(X) - X, 1e-3, 1e3)


@pytest.mark.slow
def test_switched_stiffness():
    exact, alone = farthest(3.0, 5.0, 1.0), farthest(3.0, 3.0, 1.0)
    assert exact > 1.05 * alone
    run = found(oscillator("3", "5"))
    assert run.value <= exact * (1 + 1e-12)
    assert run.value == pytest.approx(exact, rel=0.03)


@pytest.mark.slow
def test_two_times_that_are_far_apart():
    """No one grid resolves both a hump of milliseconds and a state that takes ten seconds.

    The most that |d| <= 1 makes of the hump is the integral of the size of its impulse response,
    twice the largest value of its step response.
    """
    system = replace(
        oscillator("4"),
        states=("fast", "faster", "slow"),
        modes=(Mode("one", matrix([[-100, 0, 0], [0, -1000, 0], [0, 0, "-1/10"]])),),
        channels=(Channel("push", "", Fraction(1), (matrix([[100], [1000], ["1/10"]]),)),),
        outputs=tuple(
            Output(name, "", (matrix([row]),))
            for name, row in {"hump": [-1, 1, 0], "slow": [0, 0, 1]}.items()
        ),
    )
    at = math.log(10) / 900
    hump = 2 * (math.exp(-100 * at) - math.exp(-1000 * at))
    values = [run.value for run in worst_runs(system, system.outputs)]
    assert values == pytest.approx([hump, 1], rel=0.02)
    assert values[0] <= hump * (1 + 1e-12)


def test_modes_that_take_turns():
    """Of a round of two steps, the push acts in the second one alone: 1 + 1/4 + 1/16 + ..."""
    half, names = [["1/2"]], ("first", "low", "high")
    system = replace(
        family(half, [["1/4"]], half, time=Time.DISCRETE, names=names),
        channels=(Channel("push", "", Fraction(1), tuple(matrix([[b]]) for b in (0, 1, 1))),),
        outputs=(Output("x", "", (matrix([[1]]),)),),
        clock=Clock(2, ("first",)),
    )
    run = found(system)
    assert run.value == pytest.approx(4 / 3)
    assert set(run.mode[::2]) == {0}
    assert 0 not in run.mode[1::2]


# After three steps nothing is left of a push: every product of three modes is zero.
NILPOTENT = ([[0, 2, 1], [0, 0, -1], [0, 0, 0]], [[0, -1, 3], [0, 0, 2], [0, 0, 0]])
PUSHED, WATCHED = ([1, -2, 1], [-1, 1, 2]), [1, -1, 1]
RULES = {
    "free": Switching(),
    "dwell": Switching(Fraction(2)),
    "longest": Switching(stays=(("a", Stay(Fraction(2), Fraction(3))),)),
    "resets": Switching(resets=(Reset("a", "b", matrix([[1, 0, 0], [0, -1, 0], [0, 0, 1]])),)),
}


def largest(rules, steps=7):
    """Try every path; under given modes the best push has the sign of its effect."""
    best = 0.0

    def walk(node, taken):
        nonlocal best
        if len(taken) == steps:
            p, total = np.array(WATCHED, dtype=float), 0.0
            for action in reversed(taken):
                mode = rules.mode[action]
                total += abs(p @ PUSHED[mode])
                p = p @ np.array(NILPOTENT[mode]) @ rules.jumps[rules.jump[action]]
            best = max(best, total)
            return
        for action in dict.fromkeys(rules.choices[node].tolist()):
            walk(int(rules.target[action]), [*taken, action])

    walk(0, [])
    return best


@pytest.mark.parametrize("name", RULES)
def test_it_finds_what_full_enumeration_finds(name):
    columns = tuple(matrix([[b] for b in own]) for own in PUSHED)
    system = replace(
        family(*NILPOTENT, time=Time.DISCRETE, names="ab", switching=RULES[name]),
        channels=(Channel("push", "", Fraction(1), columns),),
        outputs=(Output("x", "", (matrix([WATCHED]),)),),
    )
    assert found(system).value == pytest.approx(largest(Rules.create(system, 1.0)))


def test_what_cannot_be_searched_is_refused():
    quiet = replace(oscillator("4"), channels=())
    with pytest.raises(ValueError, match="nothing disturbs"):
        found(quiet)
    ends = Switching(fixed_ends=(("k-3", "k-5"),))
    with pytest.raises(ValueError, match="constant parameter"):
        found(oscillator("3", "5", switching=ends))


SOFT = {"soft": "{model: elastic, stiffness: 43 N*m/rad}"}
ONE = {"insertion": "{type: impedance, environment: soft, Mt: 0 kg*m^2, Bt: 2.15 N*m*s/rad}"}
BOUNDED = "contact: losable\ndisturbances: {command: 8 deg/s}\n"


def loaded(more, **options):
    text = text_of(ONE, SOFT, more=more, **options)
    return LoadedSpec(path=Path("small"), sha256="", text=text, spec=parse_spec(text))


def test_the_exact_engine_comes_to_the_same():
    """The run is simulated again by the engine that meets contact between steps, too."""
    designed = run_design(loaded(BOUNDED))
    case = run_worst_case(designed)
    run = case.runs[0]
    flies = run.states[:-1, -1] <= 0
    assert flies.any()
    assert ((run.mode >= len(case.system.modes)) == flies).all()
    width = run.time[1]
    times = np.repeat(np.arange(len(run.mode) + 1) * width, 2)[1:-1]
    profile = Profile.through(times, np.repeat(run.disturbances[:, 0], 2))
    law = designed.plant.environment("soft").nominal
    surface = Surface("soft", law.element, 0.0, 1)
    scenario = Scenario("worst", profile, float(run.time[-1]), (surface,), Control("insertion"))
    again = simulate_exactly(designed.spec, designed.plant, designed.design, scenario)
    assert np.abs(again.response["torque"]).max() == pytest.approx(run.value, rel=0.01)


FAR = spec_text("far")


@pytest.mark.parametrize("sampling", ["", "sampling: {period: 2 ms, delay: 0}\n"])
def test_what_a_scenario_reaches_is_found_too(sampling):
    """A slow motion loop lags for seconds on the way to a surface, and then presses in."""
    text = FAR + sampling
    spec = LoadedSpec(path=Path("far"), sha256="", text=text, spec=parse_spec(text))
    designed = run_design(spec)
    (run,) = run_scenarios(designed)
    force, velocity, deflection = (run.value for run in run_worst_case(designed).runs)
    assert run.metrics["peak_torque"] > 3
    assert force > run.metrics["peak_torque"]
    assert velocity > run.metrics["peak_velocity"]
    assert deflection > run.metrics["peak_depth"]


def test_nothing_that_is_found_is_beyond_a_bound():
    result = run_certification(loaded(BOUNDED), limits=Limits(optimize_rate=False))
    case = run_worst_case(result.designed, result.certificate)
    assert {run.output.name for run in case.runs} == {"force", "velocity", "deflection"}
    assert case.bounds.keys() == {"force", "velocity", "deflection"}
    for run in case.runs:
        assert 0.3 * case.bounds[run.output.name] < run.value < case.bounds[run.output.name]
    again = run_worst_case(result.designed, result.certificate)
    assert [run.value for run in again.runs] == [run.value for run in case.runs]


def test_tissue_that_creeps():
    """A command that is held comes to Bt v, whatever the tissue remembers; thesis 6.2."""
    model = "{model: kelvin-boltzmann, parallel_stiffness: 43 N*m/rad, "
    model += "series_stiffness: 43 N*m/rad, damping: 20 N*m*s/rad}"
    text = text_of(ONE, {"soft": model})
    designed = run_design(
        LoadedSpec(path=Path("small"), sha256="", text=text, spec=parse_spec(text))
    )
    case = run_worst_case(designed)
    force, velocity, deflection = case.runs
    assert force.value > 2.15 * math.radians(8) * 0.999
    assert velocity.value > math.radians(8) * 0.5
    # At rest the springs are in a row.
    assert deflection.value > force.value / 43


def test_without_disturbances_the_command_takes_its_limit():
    designed = run_design(loaded("contact: kept\n"))
    case = run_worst_case(designed)
    assert not case.declared
    (channel,) = case.system.channels
    assert (channel.name, float(channel.bound)) == ("velocity command", math.radians(8))
    # In contact that is kept, a command held forever comes to Bt v; thesis 6.2.
    assert case.runs[0].value > 2.15 * math.radians(8)
