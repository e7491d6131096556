"""A sampled loop that misses deadlines: its maps, its rule, and what is refused."""

from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from scipy.linalg import expm

from nrs_design.certificates.certificate import Verdict
from nrs_design.controllers.laws import Admittance
from nrs_design.controllers.step_law import StepFrame
from nrs_design.errors import NrsDesignError
from nrs_design.loop.calendar import Turn
from nrs_design.loop.command_timing import CommandTiming
from nrs_design.loop.held_motor import hold
from nrs_design.loop.misses import clock_of
from nrs_design.models.actuator import Actuator, ActuatorRanges
from nrs_design.proof.clock import keeps_turns
from nrs_design.search.certify import Limits, certify
from nrs_design.spec.misses import automaton_of
from tests.loop.frames import Frame
from tests.loop.test_sampled_loop import system_of

T, TAU, KM = 0.002, 0.0351, 4.8417e-4
KP, D = 117359.43, 1_030_000.0
A, B = 0.65, 0.16
PERIOD = Fraction(1, 500)
# Friction and noise are none, so the rest of a map is exact but for floating point.
NEAR = {"rel": 1e-9, "abs": 1e-9}


def frame_of(missed: Turn, delay: int, late: float = 0.0) -> Frame:
    ranges = ActuatorRanges.point(Actuator(Fraction(KM), Fraction(TAU)))
    timing = CommandTiming(PERIOD, Fraction(late), Fraction(late))
    law = Admittance.discrete(Fraction(A), Fraction(B), PERIOD)
    step = StepFrame(Fraction(KP), Fraction(D))
    return Frame(timing, hold(ranges, timing), step, (law,), delay, turns=(Turn.BOTH, missed))


def corner(frame: Frame, k: float, b: float) -> dict[str, Fraction]:
    _, values = next(frame.motor.box.named_values(""))
    return values | {"k": Fraction(k), "b": Fraction(b)}


@pytest.mark.parametrize("missed", [Turn.HELD, Turn.ZEROED])
@pytest.mark.parametrize("late", [0.0, 0.0007, 0.0031])
def test_maps_are_those_of_a_simulation_with_missed_updates(missed, late):
    """The law is called or is not; the motor is followed by matrix exponentials in between.

    Latencies: at once, within the period, and after the next sample.
    """
    rng, longest = np.random.default_rng(5), 2
    frame = frame_of(missed, longest, late)
    names = [name.split(" [")[0] for name in frame.states]
    n, (law,) = len(names), frame.laws
    flow = np.zeros((3, 3))
    flow[:2] = [[0, 1, 0], [0, -1 / TAU, KM / TAU]]
    x = rng.normal(size=n)
    at = dict(zip(names, x, strict=True))
    theta, omega, before, vm = (at[name] for name in ("delta", "omega", "e before", "vm"))
    reference = at["e"] + theta
    samples = [at[f"F {j} before"] for j in (1, 2)]
    # Commands that were sent, the newest last, each with the time at which it takes effect.
    sent = [(late - age * T, at[f"u {age} before"]) for age in (2, 1) if f"u {age} before" in names]
    last = sent[-1][1] if sent else at.get("u held", 0.0)
    in_force = sent[0][1] if sent else last
    for t in range(40):
        now, miss = t * T, bool(rng.random() < 0.5)
        k, b, age = rng.uniform(0, 60), rng.uniform(0, 5), int(rng.integers(0, longest + 1))
        force = k * theta + b * omega
        if miss:
            last = last if missed is Turn.HELD else 0.0
        else:
            e = reference - theta
            last, before = KP * e + D * (e - before), e
            felt = [force, *samples][age]
            reference, vm = reference - float(law.numbers["T"]) * vm, A * vm + B * felt
        samples = [force, *samples][:longest]
        sent.append((now + late, last))
        time = now
        for when, command in [*sent, (now + T, None)]:
            if when > time + 1e-12 or command is None:
                until = min(when, now + T)
                theta, omega, _ = expm(flow * (until - time)) @ [theta, omega, in_force]
                time = until
            if command is not None and when <= now + T - 1e-12:
                in_force = command
        sent = [item for item in sent if item[0] > now + T - 1e-12]
        turn = missed if miss else Turn.BOTH
        rows = np.array(frame.rows(law, age, corner(frame, k, b), turn), dtype=float)
        x = rows[:n, :n] @ x
    wanted = {"delta": theta, "omega": omega, "e before": before, "vm": vm}
    wanted |= {"e": reference - theta, "F 1 before": samples[0], "F 2 before": samples[1]}
    found = dict(zip(names, x, strict=True))
    assert {name: found[name] for name in wanted} == pytest.approx(wanted, **NEAR)
    if "u held" in names:
        assert found["u held"] == pytest.approx(last, **NEAR)
    assert ("u held" in names) is (missed is Turn.HELD and not late)


def loop(path, misses, *changes):
    rule = f", misses: {misses}" if misses else ""
    return system_of(path, f"{{period: 2 ms, delay: [0, 1]{rule}}}", *changes)


def test_steps_in_time_are_those_of_the_loop_without_misses(tmp_path):
    plain = {mode.name: mode.A for mode in loop(tmp_path, "").modes}
    zeroed = loop(tmp_path, "{consecutive: 2, command: zero}")
    found = {mode.name: mode.A for mode in zeroed.modes}
    assert {name: found[name] for name in plain} == plain
    in_time = {name for name in zeroed.clock.first if "/free" not in name}
    assert in_time == plain.keys()
    assert all(name.startswith("miss/soft") for name in found.keys() - plain.keys())
    held = loop(tmp_path, "{consecutive: 2, command: hold}")
    i = held.states.index("u held")
    for mode in held.modes:
        if mode.name in plain:
            rows = mode.A.fractions()
            assert not any(row[i] for row in rows)  # A new command takes the place of the old one.
            rows = [[*row[:i], *row[i + 1 :]] for k, row in enumerate(rows) if k != i]
            assert rows == plain[mode.name].fractions()


def test_what_is_rounded_in_a_missed_period_is_nothing(tmp_path):
    system = loop(tmp_path, "{consecutive: 1, command: hold}")
    for k, mode in enumerate(system.modes):
        for item in system.roundings:
            in_time = mode.name in system.clock.first
            assert in_time or not any(item.rows[k].numerators[0])


@pytest.mark.parametrize(("most", "of"), [(2, 3), (2, 4), (1, 5)])
def test_words_that_the_clock_allows_are_those_of_every_window(most, of):
    clock = clock_of(automaton_of(most, of), ("in time",))
    name = {True: "miss", False: "in time"}
    for length in range(1, 7):
        for word in product((False, True), repeat=length):
            forever = word * (of + length)
            allowed = all(sum(forever[k : k + of]) <= most for k in range(length))
            steps = [(name[missed], Fraction(1)) for missed in word]
            assert keeps_turns(clock, steps) is allowed


def test_one_miss_after_another_is_proved(tmp_path):
    """Nominal motor, contact kept and lost, with what single precision rounds."""
    rule = "{period: 2 ms, delay: 0, misses: {consecutive: 1, command: hold}}"
    system = system_of(tmp_path, rule)
    done = certify(system, limits=Limits(optimize_rate=False))
    assert done.verdict is Verdict.PROVED
    assert done.evidence.covers_rounding
    claim = done.evidence.claim(system)
    assert "that the rule for missed deadlines allows" in claim
    text = " ".join(system.assumptions)
    assert "at most 1 period in a row miss their deadline" in text
    assert "Any switching signal is possible" not in text


def test_many_in_a_row_are_refuted_by_a_word_that_the_rule_allows(tmp_path):
    rule = "{period: 2 ms, delay: 0, misses: {consecutive: 40, command: hold}}\ncontact: kept"
    system = system_of(tmp_path, rule)
    done = certify(system, limits=Limits(budget=20))
    assert done.verdict is Verdict.REFUTED
    whole = np.eye(system.order)
    matrices = {mode.name: np.array(mode.A.floats()) for mode in system.modes}
    for name, count in done.evidence.steps:
        whole = np.linalg.matrix_power(matrices[name], int(count)) @ whole
    assert np.abs(np.linalg.eigvals(whole)).max() > 1
    assert keeps_turns(system.clock, done.evidence.steps)


@pytest.mark.parametrize(
    ("rule", "said"),
    [
        ("{command: hold}", "write `{command: hold, at_most: 2, of: 10}`"),
        ("{at_most: 2, command: hold}", "write both"),
        ("{at_most: 3, of: 3, command: hold}", "that is every one"),
        ("{at_most: 4, of: 3, command: hold}", "write a longer window"),
        ("{at_most: 10, of: 30, command: zero}", "at most 1000 are built"),
        ("{consecutive: 1}", "command"),
        ("{consecutive: 1, command: hold, job: skip}", "the period that it skips is the one"),
        ("{consecutive: 0, command: hold}", "1"),
    ],
)
def test_rules_that_are_none(tmp_path, rule, said):
    with pytest.raises(NrsDesignError) as caught:
        loop(tmp_path, rule)
    assert said in str(caught.value)
