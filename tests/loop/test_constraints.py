"""Rules of switching, carried over to the assembled modes and put into words."""

from fractions import Fraction
from itertools import pairwise, product
from pathlib import Path

import pytest

from nrs_design.errors import AssemblyError
from nrs_design.loop import constraints
from nrs_design.loop.assemble import assemble, assemble_from_text
from nrs_design.loop.constraints import count_stays
from nrs_design.pipeline.runs import run_design
from nrs_design.spec import SwitchingSpec, parse_spec
from tests.loop.support import assembled, loaded
from tests.support import words_of
from tests.tables import cases_of, spec_text

HEAD = "kind: switched-system\nname: s\ntime: {}\n"
PAIR = spec_text("ruled-pair")
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


# Dwell times of sampled loops: the automaton allows what they allow, and nothing else.
MODES = {"a": ["a/1", "a/2"], "b": ["b"], "c": ["c"]}


def counted(rules: dict, period="1/2", modes=MODES):
    return count_stays(SwitchingSpec.model_validate(rules), modes, Fraction(period))[0]


def lasts(word: str, counts: dict[str, int], pairs) -> bool:
    """Tell whether every stay but the first and the last is as long as it must be."""
    runs = [[word[0], 1]]
    for before, name in pairwise(word):
        if name == before:
            runs[-1][1] += 1
        else:
            if pairs is not None and (before, name) not in pairs:
                return False
            runs.append([name, 1])
    return all(count >= counts[name] for name, count in runs[1:-1])


@pytest.mark.parametrize(
    ("rules", "counts"),
    [
        ({"dwell_time": "1.5 s"}, {"a": 3, "b": 3, "c": 3}),
        # A stay of 1.1 s is one of three samples, of 0.1 s of one.
        ({"dwell_time": {"a": "1.1 s", "b": "0.1 s"}}, {"a": 3, "b": 1, "c": 1}),
        ({"dwell_time": "1 s"}, {"a": 2, "b": 2, "c": 2}),
        (
            {"dwell_time": {"a": "1 s"}, "transitions": [["a", "b"], ["b", "c"], ["c", "a"]]},
            {"a": 2, "b": 1, "c": 1},
        ),
    ],
)
def test_every_word_of_seven_samples(rules, counts):
    clock = counted(rules)
    assert (clock.first, clock.more) == (("a/1", "a/2"), (("b",),))
    pairs = SwitchingSpec.model_validate(rules).transitions
    for word in map("".join, product("abc", repeat=7)):
        kinds = ["abc".index(name) for name in word]
        found = False
        for state in range(clock.length):
            for kind in kinds:
                state = None if state is None else clock.after(state, kind)
            found = found or state is not None
        assert found is lasts(word, counts, pairs), word


def test_without_long_stays_there_is_no_automaton():
    assert counted({"dwell_time": "0.5 s"}) is None
    assert counted({"transitions": [["a", "b"]]}) is None
    assert counted({"dwell_time": "5 s"}, modes={"a": ["a"]}) is None


def test_stays_of_too_many_samples_are_refused_with_what_to_write():
    """To count fewer would prove less than is asked, and refute what is not there."""
    with pytest.raises(AssemblyError, match="2003 samples long, at most 1000") as refused:
        counted({"dwell_time": {"a": "1000 s", "b": "1 s"}})
    assert "333 samples each, which is 166.5 s" in refused.value.remedy


STAYS = spec_text("counted-stays")
ALONE = "  mild: {type: impedance, environment: soft, Mt: 0.2 kg*m^2, Bt: 3 N*m*s/rad}\n", ""


def test_a_dwell_time_of_a_controller_is_none_of_its_modes():
    """The tissue may change at every sample: one controller alone is as if switching were free."""
    alone = assembled(STAYS, ALONE)
    free = assembled(STAYS, ALONE, ("{dwell_time: 0.1 s}", "arbitrary"))
    assert alone.clock is None
    assert alone.switching == free.switching
    two = assembled(STAYS)
    assert two.switching.is_arbitrary
    assert two.clock.length == 2 * 9
    assert "at least so many samples: firm 9, mild 9" in " ".join(words_of(two))


def test_at_points_a_period_has_its_length():
    """A word of so many samples there is shorter in time than with the longest periods."""
    found = run_design(loaded(STAYS))
    system = assemble(found.spec, found.plant, found.design, points="ends")
    assert system.clock.length == 2 * 10
