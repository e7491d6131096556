"""Rules of switching, carried over to the assembled modes and put into words."""

from fractions import Fraction
from pathlib import Path

import pytest

from nrs_design.errors import AssemblyError
from nrs_design.loop import constraints
from nrs_design.loop.assemble import assemble_from_text
from nrs_design.spec import parse_spec
from tests.loop.support import assembled
from tests.support import words_of
from tests.tables import cases_of

HEAD = "kind: switched-system\nname: s\ntime: {}\n"
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
CASES = cases_of(Path(__file__).with_suffix(".yaml"), "cases")


def system_of(case):
    rules = case["rules"]
    if "pair" in case:
        stiffness, contacts = case["pair"]
        made = ("STIFFNESS", stiffness), ("CONTACTS", contacts), ("RULES", rules)
        return assembled(PAIR, *made)
    text = HEAD.format(case.get("time", "continuous")) + case["modes"] + f"switching: {rules}\n"
    return assemble_from_text(parse_spec(text), {})


def edge_text(edge):
    entries = [] if edge.map is None else [e for row in edge.map.fractions() for e in row]
    return " ".join([f"{edge.source.name} > {edge.target.name}", *map(str, entries)])


def pairs(said):
    return None if said is None else {tuple(item.split(" > ")) for item in said}


@pytest.mark.parametrize("case", CASES)
def test_what_becomes_of_rules(case):
    system = system_of(case)
    rules, words = system.switching, words_of(system)
    if "dwell_time" in case:
        assert rules.dwell_time == Fraction(case["dwell_time"])
    if "transitions" in case:
        found = rules.transitions
        assert (None if found is None else set(found)) == pairs(case["transitions"])
    if "resets" in case:
        assert {(r.source, r.target) for r in rules.resets} == pairs(case["resets"])
    if "stays" in case:
        found = {name: [stay.shortest, stay.longest] for name, stay in rules.stays}
        assert found == case["stays"]
    if "edges" in case:
        assert [*map(edge_text, system.edges())] == case["edges"]
    if "count" in case:
        assert len(system.edges()) == case["count"]
    assert [*map(list, rules.fixed_ends)] == case.get("fixed_ends", [*map(list, rules.fixed_ends)])
    said = case.get("says", [])
    assert [*words[len(words) - len(said) :]] == said
    assert [text for text in case.get("among", []) if text not in words] == []
    assert rules.is_arbitrary is (case["rules"] == "arbitrary" and not rules.fixed_ends)


def test_long_lists_are_counted():
    pairs = ", ".join(f"[m{i}, m{i + 1}]" for i in range(30))
    modes = "modes:\n" + "".join(f"  - {{name: m{i}, A: [[-1]]}}\n" for i in range(31))
    system = system_of({"modes": modes, "rules": f"{{transitions: [{pairs}]}}"})
    assert words_of(system)[-1] == (
        "The mode changes only along the 30 transitions that the spec lists."
    )


def test_states_of_different_sizes():
    (case,) = (item.values[0] for item in CASES if "[0, -2]" in item.values[0].get("modes", ""))
    system = system_of(case)
    assert (system.order, system.states) == (2, ("x1", "x2"))
    assert not system.is_uniform
    assert [edge.map.shape for edge in system.edges()] == [(2, 1), (1, 2)]


def test_too_many_switches(monkeypatch):
    monkeypatch.setattr(constraints, "MAX_ASSEMBLED", 3)
    for name, rules in (
        ("m", "arbitrary\nresets: [{from: a, to: b, map: [[2]]}]"),
        ("k", "{transitions: [[a, b]]}"),
    ):
        modes = next(c.values[0]["modes"] for c in CASES if f"- {name}" in str(c.values[0]))
        with pytest.raises(AssemblyError, match="more than 3 switches"):
            system_of({"modes": modes, "rules": rules})
    assert system_of({"modes": modes, "rules": "arbitrary"}).switching.is_arbitrary
