"""A sampled loop that misses deadlines: its maps, its rule, and what is refused."""

from fractions import Fraction
from itertools import product

import numpy as np
import pytest

from nrs_design.certificates.certificate import Verdict
from nrs_design.errors import NrsDesignError
from nrs_design.loop.misses import clock_of
from nrs_design.proof.clock import keeps_turns
from nrs_design.search.certify import Limits, certify
from nrs_design.spec.misses import automaton_of
from tests.loop.test_sampled_loop import system_of
from tests.support import words_of


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
    text = " ".join(words_of(system))
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
