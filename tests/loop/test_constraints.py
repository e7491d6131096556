"""Rules of switching, carried over to the assembled modes and put into words."""

from fractions import Fraction

import pytest

from nrs_design.certificates.catalogue import sentence
from nrs_design.controllers.gains import gains_of
from nrs_design.errors import AssemblyError
from nrs_design.loop import constraints
from nrs_design.loop.assemble import GIVEN_MATRICES, assemble_from_text
from nrs_design.pipeline.runs import run_design
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.switching import Reset, Stay
from nrs_design.spec import LoadedSpec, parse_spec
from tests.support import words_of

HEAD = "kind: switched-system\nname: s\ntime: continuous\n"
TWO = "modes:\n  - {name: a, A: [[-1]]}\n  - {name: b, A: [[-2]]}\n"
BOX = """\
parameters: {k: {nominal: 1, range: [0, 2]}}
modes:
  - {name: a, A: [["-1 - k"]]}
  - {name: b, A: [[-2]]}
"""
CONSTANT = """\
parameters: {m: {nominal: 1, range: [0, 2], varies: false}}
modes:
  - {name: a, A: [["-1 - m"]]}
  - {name: b, A: [["-2 - m"]]}
"""
PAIR = """\
kind: interaction-design
name: pair
actuator: {gain: 4.8417e-4 rad/s/rpm, time_constant: 0.0351 s}
motion_loop: {damping_ratio: 0.707, settling_time: 0.1404 s}
limits: {velocity: 8 deg/s, torque: 0.3 N*m, bandwidth: 2 Hz}
environments:
  soft: {model: elastic, stiffness: STIFFNESS}
  hand: {model: elastic, stiffness: 50 N*m/rad}
controllers:
  insertion: {type: impedance, environment: soft, Mt: 0.01 kg*m^2, Bt: 2.15 N*m*s/rad,
    contacts: CONTACTS}
  withdrawal: {type: impedance, environment: soft, Mt: 0.01 kg*m^2, Bt: 1.04 N*m*s/rad}
switching: RULES
"""
RANGE = "{nominal: 43 N*m/rad, range: [40 N*m/rad, 45 N*m/rad]}"


def given(body, rules, time="continuous"):
    text = HEAD.replace("continuous", time) + body + f"switching: {rules}\n"
    return assemble_from_text(parse_spec(text), {})


def pair(rules, stiffness="43 N*m/rad", contacts="[soft]"):
    text = PAIR.replace("RULES", rules).replace("STIFFNESS", stiffness)
    spec = parse_spec(text.replace("CONTACTS", contacts))
    gains = gains_of(run_design(LoadedSpec(path="pair", sha256="", text=text, spec=spec)).design)
    return assemble_from_text(spec, gains)


def test_dwell_time_in_seconds():
    system = given(TWO, "{dwell_time: 2760 ms}")
    assert system.switching.dwell_time == Fraction("2.76")
    assert system.switching.transitions is None
    assert not system.switching.is_arbitrary
    assert words_of(system)[1:] == (
        "The state is continuous at a switch (identity resets).",
        "Every mode stays active for at least 2.76 s before the next switch.",
        "Any mode may follow any other.",
    )


def test_dwell_time_in_steps():
    system = given(TWO, "{dwell_time: 3 steps, transitions: [[a, b]]}", "discrete")
    assert system.switching.dwell_time == 3
    assert "Every mode stays active for at least 3 steps before the next switch." in (
        words_of(system)
    )
    assert words_of(system)[-1] == "The mode changes only from a to b."


def test_transitions():
    system = given(TWO, "{transitions: [[b, a]]}")
    assert system.switching.transitions == (("b", "a"),)
    assert [(edge.source.name, edge.target.name) for edge in system.edges()] == [("b", "a")]


def test_corners_of_one_mode_follow_each_other_freely():
    system = given(BOX, "{transitions: [[a, b]]}")
    assert set(system.switching.transitions) == {
        ("a/k-min", "a/k-max"),
        ("a/k-max", "a/k-min"),
        ("a/k-min", "b"),
        ("a/k-max", "b"),
    }
    assert "Parameter k stays in [0, 2] and may change arbitrarily fast." in words_of(system)


def test_a_constant_parameter_is_kept_apart_from_the_transitions():
    # Stability may be argued for more signals than there are, never for fewer: a function for each
    # end alone says nothing about the values between them.
    system = given(CONSTANT, "arbitrary")
    assert system.switching.transitions is None
    assert not system.switching.is_arbitrary
    assert len(system.edges()) == 12
    assert system.switching.fixed_ends == (("a/m-min", "a/m-max"), ("b/m-min", "b/m-max"))
    assert words_of(system)[1:] == (
        "Parameter m is unknown in [0, 2], but constant: it has one value in all modes and at all "
        "times.",
        sentence(GIVEN_MATRICES[1]),
    )


def test_resets_hold_for_all_corners():
    system = given(BOX, "arbitrary\nresets: [{from: a, to: b, map: [['1/2']]}]")
    half = RationalMatrix(((1,),), 2)
    assert system.switching.resets == (Reset("a/k-min", "b", half), Reset("a/k-max", "b", half))
    assert system.switching.transitions is None
    low, high, b = system.modes
    maps = {(edge.source, edge.target): edge.map for edge in system.edges()}
    assert maps[low, b] == half
    assert maps[low, high] is None
    assert maps[b, low] is None
    assert words_of(system)[2:] == (
        "At a switch from a to b the state is mapped as the resets of the spec say; at every other "
        "switch it is continuous.",
        "Any switching signal is possible.",
    )


def test_rules_and_resets_with_a_constant_parameter():
    rules = "{transitions: [[a, b]]}\nresets: [{from: a, to: b, map: [[2]]}]"
    switching = given(CONSTANT, rules).switching
    across = {(f"a/m-{end}", f"b/m-{other}") for end in ("min", "max") for other in ("min", "max")}
    assert {(r.source, r.target) for r in switching.resets} == across
    assert set(switching.transitions) == across | {
        ("a/m-min", "a/m-max"),
        ("a/m-max", "a/m-min"),
        ("b/m-min", "b/m-max"),
        ("b/m-max", "b/m-min"),
    }


def test_states_of_different_sizes():
    body = "modes:\n  - {name: a, A: [[-1]]}\n  - {name: b, A: [[-1, 0], [0, -2]]}\n"
    rules = (
        "{transitions: [[a, b], [b, a]]}\n"
        "resets: [{from: a, to: b, map: [[1], [0]]}, {from: b, to: a, map: [[1, 0]]}]"
    )
    system = given(body, rules)
    assert system.order == 2
    assert system.states == ("x1", "x2")
    assert not system.is_uniform
    assert [edge.map.shape for edge in system.edges()] == [(2, 1), (1, 2)]


def test_long_lists_are_counted():
    pairs = ", ".join(f"[m{i}, m{i + 1}]" for i in range(30))
    modes = "modes:\n" + "".join(f"  - {{name: m{i}, A: [[-1]]}}\n" for i in range(31))
    system = given(modes, f"{{transitions: [{pairs}]}}")
    assert words_of(system)[-1] == (
        "The mode changes only along the 30 transitions that the spec lists."
    )


def test_too_many_switches(monkeypatch):
    monkeypatch.setattr(constraints, "MAX_ASSEMBLED", 3)
    with pytest.raises(AssemblyError, match="more than 3 switches"):
        given(CONSTANT, "arbitrary\nresets: [{from: a, to: b, map: [[2]]}]")
    with pytest.raises(AssemblyError, match="more than 3 switches"):
        given(BOX, "{transitions: [[a, b]]}")
    assert given(BOX, "arbitrary").switching.is_arbitrary


def test_controllers_in_order():
    system = pair("{transitions: [[insertion, withdrawal]]}", RANGE)
    assert set(system.switching.transitions) == {
        *(("insertion/soft/k-min", f"withdrawal/soft/k-{end}") for end in ("min", "max")),
        *(("insertion/soft/k-max", f"withdrawal/soft/k-{end}") for end in ("min", "max")),
        ("insertion/soft/k-min", "insertion/soft/k-max"),
        ("insertion/soft/k-max", "insertion/soft/k-min"),
        ("withdrawal/soft/k-min", "withdrawal/soft/k-max"),
        ("withdrawal/soft/k-max", "withdrawal/soft/k-min"),
    }
    assert {
        "States are continuous at a switch (identity resets).",
        "The controller changes only from insertion to withdrawal.",
        "While a controller is active, the environment that it touches may change among its "
        "contacts at any time.",
    } <= set(words_of(system))


def test_contacts_change_freely():
    system = pair("{transitions: [[withdrawal, insertion]]}", contacts="[soft, hand]")
    assert set(system.switching.transitions) == {
        ("insertion/soft", "insertion/hand"),
        ("insertion/hand", "insertion/soft"),
        ("withdrawal/soft", "insertion/soft"),
        ("withdrawal/soft", "insertion/hand"),
    }


def test_controllers_with_a_dwell_time():
    system = pair("{dwell_time: 0.5 s}")
    assert system.switching.dwell_time == Fraction(1, 2)
    assert {
        "Every controller stays active for at least 0.5 s before the next switch.",
        "Any controller may follow any other.",
    } <= set(words_of(system))


def test_times_by_mode():
    rules = "{dwell_time: {b: 2 steps}, longest_dwell_time: {a: 1 step}}"
    system = given(TWO, rules, "discrete")
    assert system.switching.dwell_time == 0
    assert system.stays() == {"a": Stay(Fraction(1), Fraction(1)), "b": Stay(Fraction(2))}
    assert [mode.name for mode in system.lasting_modes()] == ["b"]
    assert words_of(system)[-3:] == (
        "Mode b stays active for at least 2 steps before the next switch.",
        "Mode a is left after at most 1 step.",
        "Any mode may follow any other.",
    )


def test_one_dwell_time_needs_no_list():
    assert given(TWO, "{dwell_time: 2 s}").switching.stays == ()
    both = given(TWO, "{dwell_time: 2 s, longest_dwell_time: {b: 3 s}}").switching
    assert both.stays == (("b", Stay(Fraction(2), Fraction(3))),)
    assert both.stay("a") == Stay(Fraction(2))


def test_each_reset_is_an_edge():
    resets = "[{from: a, to: b, map: [[2]]}, {from: a, to: b, map: [[3]]}]"
    system = given(TWO, f"arbitrary\nresets: {resets}")
    edges = [(e.source.name, e.target.name, e.map and e.map.fractions()) for e in system.edges()]
    assert edges == [("a", "b", [[2]]), ("a", "b", [[3]]), ("b", "a", None)]
    assert words_of(system)[1] == (
        "At a switch from a to b the state is mapped as the resets of the spec say; at every other "
        "switch it is continuous. Where several resets lead from one mode to another, any one of "
        "them may happen, and always one of them does."
    )


def test_controllers_that_must_be_left():
    system = pair("{longest_dwell_time: {insertion: 5 s}}")
    assert system.switching.stays == (("insertion/soft", Stay(Fraction(0), Fraction(5))),)
    assert "Controller insertion is left after at most 5 s." in words_of(system)
