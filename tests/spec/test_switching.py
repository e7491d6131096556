"""Rules of switching and resets, in both kinds of specs."""

from fractions import Fraction

import pytest

from nrs_design.spec.switching import DwellTime, SwitchingSpec, parse_dwell_time

from .samples import (
    IMPEDANCE,
    SWITCHED,
    interaction,
    refusal,
    spoiled,
    switched,
)

RULES = "switching: {dwell_time: 2.76 s, transitions: [[a, b], [b, a]]}\n"
RESETS = """\
resets:
  - {from: a, to: b, map: [[1, 0], [0, "1/2"]]}
"""
SAMPLE = spoiled(SWITCHED, "switching: arbitrary\n", RULES + RESETS)
UNEQUAL = """\
kind: switched-system
name: unequal
time: continuous
modes:
  - {name: a, A: [[-1, -1], [1, -1]]}
  - {name: b, A: [[-1]]}
switching: arbitrary
resets:
  - {from: a, to: b, map: [[1, 0]]}
  - {from: b, to: a, map: [[1], [0]]}
"""
PAIR = IMPEDANCE.replace(
    "switching: arbitrary",
    """\
  withdrawal: {type: impedance, environment: soft, Mt: 0.01 kg*m^2, Bt: 1.04 N*m*s/rad}
switching: {dwell_time: 500 ms, transitions: [[insertion, withdrawal]]}""",
)


def test_reads_rules_and_resets() -> None:
    spec = switched(SAMPLE)
    assert spec.switching.dwell_time == DwellTime("2.76 s", Fraction("2.76"), "s")
    assert spec.switching.transitions == (("a", "b"), ("b", "a"))
    assert not spec.switching.is_arbitrary
    (reset,) = spec.resets
    assert (reset.source, reset.target, reset.shape) == ("a", "b", (2, 2))
    assert reset.map == ((1, 0), (0, Fraction(1, 2)))


def test_arbitrary_has_no_rules() -> None:
    assert switched(SWITCHED).switching == SwitchingSpec()
    assert str(switched(SWITCHED).switching) == "arbitrary"
    assert str(switched(SAMPLE).switching) == "dwell time 2.76 s, 2 allowed transitions"


def test_only_allowed_switches_need_a_reset() -> None:
    text = spoiled(UNEQUAL, "switching: arbitrary", "switching: {transitions: [[b, a]]}")
    text = spoiled(text, "  - {from: a, to: b, map: [[1, 0]]}\n", "")
    assert len(switched(text).resets) == 1
    assert switched(spoiled(text, "[[b, a]]", "[]").partition("resets:")[0]).resets == ()


def test_rules_of_controllers() -> None:
    spec = interaction(PAIR)
    assert spec.switching.dwell_time == DwellTime("500 ms", Fraction(1, 2), "s")
    assert spec.switching.transitions == (("insertion", "withdrawal"),)


@pytest.mark.parametrize(
    ("text", "value"), [("3 steps", 3), ("1 step", 1), ("4096 steps", 4096), ("1e2 steps", 100)]
)
def test_steps(text: str, value: int) -> None:
    assert parse_dwell_time(text) == DwellTime(text, Fraction(value), "steps")
    discrete = spoiled(SWITCHED, "continuous", "discrete")
    spec = switched(spoiled(discrete, "arbitrary", f"{{dwell_time: {text}}}"))
    assert spec.switching.dwell_time == DwellTime(text, Fraction(value), "steps")


def test_a_range_that_is_not_touched_does_not_matter() -> None:
    text = spoiled(PAIR, "43 N*m/rad", "{nominal: 43 N*m/rad, range: [40 N*m/rad, 50 N*m/rad]}")
    assert interaction(text).switching.dwell_time is not None


def test_damping_moves_too() -> None:
    text = spoiled(PAIR, "    environment: soft\n", "    environment: hand\n")
    assert interaction(text).switching.dwell_time is not None
    ranged = "{nominal: 0.5 N*m*s/rad, range: [0 N*m*s/rad, 1 N*m*s/rad]}"
    error = refusal(spoiled(text, "damping: 0.5 N*m*s/rad", f"damping: {ranged}"))
    assert "beside the range of environment 'hand'" in error.message


DISCRETE = spoiled(SWITCHED, "continuous", "discrete")
STAYS = "{dwell_time: {b: 2 steps}, longest_dwell_time: {a: 1 step, b: 5 steps}}"
LEFT = spoiled(DISCRETE, "arbitrary", STAYS)


def test_times_by_mode() -> None:
    rules = switched(LEFT).switching
    two, one = DwellTime("2 steps", Fraction(2), "steps"), DwellTime("1 step", Fraction(1), "steps")
    assert rules.stay("a") == (None, one)
    assert rules.stay("b") == (two, DwellTime("5 steps", Fraction(5), "steps"))
    assert not rules.is_arbitrary
    assert str(rules) == (
        "dwell time 2 steps in b, longest dwell time 1 step in a, longest dwell time 5 steps in b"
    )


def test_one_longest_time_for_all() -> None:
    rules = switched(spoiled(SWITCHED, "arbitrary", "{longest_dwell_time: 3 s}")).switching
    assert {rules.stay(name)[1] for name in "ab"} == {DwellTime("3 s", Fraction(3), "s")}


def test_several_resets_from_one_mode_to_another() -> None:
    other = "  - {from: a, to: b, map: [[2, 0], [0, 1]]}\n"
    spec = switched(SAMPLE + other)
    assert [(reset.source, reset.target) for reset in spec.resets] == [("a", "b"), ("a", "b")]
    error = refusal(SAMPLE + other + spoiled(other, "[2, 0]", "[2.0, 0]"))
    assert "this reset is listed twice" in error.message


def test_controllers_that_must_be_left() -> None:
    text = spoiled(PAIR, "dwell_time: 500 ms", "longest_dwell_time: {insertion: 5 s}")
    text = spoiled(
        text, "[[insertion, withdrawal]]", "[[insertion, withdrawal], [withdrawal, insertion]]"
    )
    assert interaction(text).switching.stay("insertion")[1] == DwellTime("5 s", Fraction(5), "s")
    moving = spoiled(
        text, "    environment: soft\n", "    environment: soft\n    contacts: [soft, hand]\n"
    )
    assert "leave longest_dwell_time out" in str(refusal(moving).remedy)
