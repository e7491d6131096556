"""Rules of switching and resets, in both kinds of specs."""

from fractions import Fraction

import pytest

from nrs_design.spec.switching import DwellTime, SwitchingSpec, parse_dwell_time

from .samples import (
    IMPEDANCE,
    SWITCHED,
    assert_refused,
    interaction,
    message_of,
    place_of,
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
    ("old", "new", "at", "said"),
    [
        ("2.76 s", "2.76", "2.76", "write '2.76 s'"),
        ("2.76 s", "4097 s", "4097 s", "not between 0 and 4096 s"),
        ("2.76 s", "3 steps", "3 steps", "not a dwell time in continuous time, expected s"),
        ("2.76 s", "3 N", "3 N", "not a dwell time"),
        ("2.76 s", "3 stepz", "3 stepz", "unknown unit 'stepz'"),
        ("dwell_time", "dwel_time", "dwel_time", "did you mean dwell_time?"),
        ("[[a, b], [b, a]]}", "[[a, c], [b, a]]}", "c], [b, a]]", "there is no mode 'c'"),
        ("[[a, b], [b, a]]}", "[[a, a]]}", "[a, a]", "leads to another mode"),
        ("[[a, b], [b, a]]}", "[[a, b], [a, b]]}", "[a, b]]}", "listed twice"),
        ("[[a, b], [b, a]]}", "[a, b]}", "a, b]}", "write [from, to]"),
        ("[[a, b], [b, a]]}", "[[a, b, a]]}", "[a, b, a]", "write [from, to]"),
        ("[[a, b], [b, a]]}", "[[a, [b]]]}", "[b]]", "single value"),
        ("[[a, b], [b, a]]}", "all}", "all}", "expected a list"),
        ("[[a, b], [b, a]]}", "[[b, a]]}", "{from: a", "from a to b is not allowed"),
        ("from: a", "from: c", "c, to", "there is no mode 'c'"),
        ("to: b", "to: c", "c, map", "there is no mode 'c'"),
        ("to: b", "to: a", "a, map", "leads to another mode"),
        ("from: a, ", "", "{to: b", "resets[0].from` is missing"),
        ("from: a", "form: a", "form", "did you mean from?"),
        ('[[1, 0], [0, "1/2"]]', "[[1, 0]]", "[[1, 0]]", "1 x 2, expected 2 x 2"),
        ('[[1, 0], [0, "1/2"]]', "[[1, 0], [1]]", "[1]]", "row 2 has 1 entries"),
        ('[[1, 0], [0, "1/2"]]', "[[1, 0], [0, k]]", "k]]", "not a number"),
        ('[[1, 0], [0, "1/2"]]', "[]", "[]}", "must not be empty"),
        (
            '[0, "1/2"]]}',
            "[0, 1]]}\n  - {to: b, from: a, map: [[1, 0], [0, 1]]}",
            "{to: b",
            "listed twice",
        ),
    ],
)
def test_refuses_with_place_and_remedy(old: str, new: str, at: str, said: str) -> None:
    assert_refused(spoiled(SAMPLE, old, new), said, at)


@pytest.mark.parametrize("rules", ["{}", "slow", "Arbitrary", "[a, b]", "[]"])
def test_refuses_what_is_no_rule(rules: str) -> None:
    text = spoiled(SWITCHED, "switching: arbitrary", f"switching: {rules}")
    error = refusal(text)
    assert (error.line, error.column) == place_of(text, f"{rules}\n")


def test_missing_reset_is_reported_at_the_transition() -> None:
    text = spoiled(UNEQUAL, "switching: arbitrary", "switching: {transitions: [[a, b], [b, a]]}")
    text = spoiled(text, "  - {from: b, to: a, map: [[1], [0]]}\n", "")
    error = refusal(text)
    assert "add {from: b, to: a, map: ...} with 2 x 1 entries" in str(error.remedy)
    assert (error.line, error.column) == place_of(text, "[b, a]]}")


@pytest.mark.parametrize(
    ("text", "value"), [("3 steps", 3), ("1 step", 1), ("4096 steps", 4096), ("1e2 steps", 100)]
)
def test_steps(text: str, value: int) -> None:
    assert parse_dwell_time(text) == DwellTime(text, Fraction(value), "steps")
    discrete = spoiled(SWITCHED, "continuous", "discrete")
    spec = switched(spoiled(discrete, "arbitrary", f"{{dwell_time: {text}}}"))
    assert spec.switching.dwell_time == DwellTime(text, Fraction(value), "steps")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("2.5 steps", "not a whole number"),
        ("1/2 steps", "not a whole number"),
        ("0 s", "not between 0 and 4096 s"),
        ("0 steps", "not between 0 and 4096 steps"),
        ("-3 steps", "not between 0 and 4096 steps"),
        ("4097 steps", "not between 0 and 4096 steps"),
        ("many steps", "not a number"),
        (" steps", "is empty"),
        ("1e-40 s", "not a physical magnitude"),
        ("nan s", "not a finite number"),
    ],
)
def test_refuses_dwell_times(text: str, said: str) -> None:
    assert said in message_of(lambda: parse_dwell_time(text))


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


@pytest.mark.parametrize(
    ("sample", "old", "new", "at", "said"),
    [
        (
            UNEQUAL,
            "  - {from: b, to: a, map: [[1], [0]]}\n",
            "",
            "[[-1, -1]",
            "b to a has no reset",
        ),
        (UNEQUAL, "[[1], [0]]", "[[2, 0]]", "[[2, 0]]", "1 x 2, expected 2 x 1"),
        (UNEQUAL, "[[1, 0]]", "[[2], [0]]", "[[2], [0]]", "2 x 1, expected 1 x 2"),
        (PAIR, "withdrawal]]", "withdrawel]]", "withdrawel", "did you mean withdrawal?"),
        (PAIR, "500 ms", "5 steps", "5 steps", "is not a time"),
        (LEFT, "{b: 2 steps}", "{c: 2 steps}", "2 steps}", "there is no mode 'c'"),
        (LEFT, "{b: 2 steps}", "{}", "{}, longest", "no mode is named"),
        (LEFT, "{b: 2 steps}", "{b: [2]}", "[2]", "single value"),
        (LEFT, "b: 2 steps", "b: 2 s", "2 s}", "not a dwell time in discrete time, expected steps"),
        (LEFT, "b: 2 steps", "b: 2.5 steps", "2.5 steps", "not a whole number"),
        (LEFT, "b: 2 steps", "b: 6 steps", "5 steps}}", "after 5 steps, but not before 6 steps"),
        (LEFT, "a: 1 step,", "a: 1 s,", "1 s,", "not a dwell time in discrete time"),
        (LEFT, "5 steps}}", "5 steps}, transitions: [[b, a]]}", "1 step,", "nothing may follow it"),
    ],
)
def test_refuses_what_does_not_fit(sample: str, old: str, new: str, at: str, said: str) -> None:
    assert_refused(spoiled(sample, old, new), said, at)


def test_a_mode_alone_cannot_be_left() -> None:
    text = spoiled(DISCRETE, "arbitrary", "{longest_dwell_time: 2 steps}")
    text = spoiled(text, '  - {name: b, A: [[-1, -6], ["1/6", -1]]}\n', "")
    assert "'a' must be left, but nothing may follow it" in refusal(text).message


def test_a_longest_time_and_a_range_exclude_each_other() -> None:
    ranged = spoiled(DISCRETE, "[[-1, -1]", '[["-k", -1]')
    ranged = spoiled(ranged, "modes:", "parameters: {k: {nominal: 1, range: [0, 1]}}\nmodes:")
    error = refusal(spoiled(ranged, "arbitrary", "{longest_dwell_time: {b: 2 steps}}"))
    assert "the range of parameter 'k' exclude each other" in error.message
    assert "leave longest_dwell_time out" in str(error.remedy)


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
