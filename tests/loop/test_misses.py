"""Loops that miss deadlines: verdicts known by hand, and by every word of a window.

That the maps of a missed period are what the pages say is asked in tests/oracle.
"""

from fractions import Fraction
from itertools import product

import numpy as np
import pytest

from nrs_design.certificates.certificate import Verdict
from nrs_design.loop.assemble import assemble_matrices
from nrs_design.loop.constraints import clock_of
from nrs_design.proof.clock import keeps_turns
from nrs_design.search.certify import Limits, certify
from nrs_design.spec import parse_spec
from nrs_design.spec.misses import automaton_of
from tests.loop.support import sampled
from tests.tables import by_rows

TEXT = """\
kind: switched-system
name: weakly-hard
time: discrete
modes:
  - {{name: hit, A: {hit}}}
  - {{name: miss, A: {miss}}}
switching: arbitrary
misses: {{mode: miss, at_most: {most}, of: {of}}}
"""


def system(hit, miss, most, of):
    text = TEXT.format(hit=listed(hit), miss=listed(miss), most=most, of=of)
    return assemble_matrices(parse_spec(text))


def listed(A):
    return [[str(Fraction(x).limit_denominator(1000)) for x in row] for row in A]


def test_signals_are_the_words_of_the_rule():
    """Of all sequences of modes, those along the switches are those of the windows."""
    found = system([[0.5]], [[1.5]], 2, 4)
    allowed = set(found.switching.transitions)
    names = [mode.name for mode in found.modes]
    once = {name for name, stay in found.switching.stays if stay.longest == 1}
    allowed |= {(name, name) for name in names if name not in once}
    words = {(name,) for name in names}
    for _ in range(7):
        words = {(*w, name) for w in words for name in names if (w[-1], name) in allowed}
    said = {tuple(int(name.startswith("miss")) for name in word) for word in words}
    expected = {
        word
        for word in product((0, 1), repeat=8)
        if all(sum(word[i : i + 4]) <= 2 for i in range(5))
    }
    assert said == expected


@by_rows("most", "of", "stable")
def test_one_state_decides_by_hand(most, of, stable):
    """0.5 and 2.5: as many misses as allowed in every window, so 0.5^(of - most) 2.5^most."""
    assert (0.5 ** (of - most) * 2.5**most < 1) is stable
    found = certify(system([[0.5]], [[2.5]], most, of))
    assert found.verdict == ("proved" if stable else "refuted")
    if stable:
        exact = (0.5 ** (of - most) * 2.5**most) ** (1 / of)
        assert exact <= float(found.evidence.proved_rate(found.system)) <= exact * 1.01


def loop(misses):
    rule = f", misses: {misses}" if misses else ""
    return sampled(f"{{period: 2 ms, delay: [0, 1]{rule}}}")


def test_steps_in_time_are_those_of_the_loop_without_misses():
    plain = {mode.name: mode.A for mode in loop("").modes}
    zeroed = loop("{consecutive: 2, command: zero}")
    found = {mode.name: mode.A for mode in zeroed.modes}
    assert {name: found[name] for name in plain} == plain
    in_time = {name for name in zeroed.clock.first if "/free" not in name}
    assert in_time == plain.keys()
    assert all(name.startswith("miss/soft") for name in found.keys() - plain.keys())


def test_what_is_rounded_in_a_missed_period_is_nothing():
    system = loop("{consecutive: 1, command: hold}")
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


def test_one_miss_after_another_is_proved():
    """Nominal motor, contact kept and lost, with what single precision rounds."""
    system = sampled("{period: 2 ms, delay: 0, misses: {consecutive: 1, command: hold}}")
    done = certify(system, limits=Limits(optimize_rate=False))
    assert done.verdict is Verdict.PROVED
    assert done.evidence.covers_rounding
    claim = done.evidence.claim(system)
    assert "that the rule for missed deadlines allows" in claim


def test_many_in_a_row_are_refuted_by_a_word_that_the_rule_allows():
    rule = "{period: 2 ms, delay: 0, misses: {consecutive: 40, command: hold}}\ncontact: kept"
    system = sampled(rule)
    done = certify(system, limits=Limits(budget=20))
    assert done.verdict is Verdict.REFUTED
    whole = np.eye(system.order)
    matrices = {mode.name: np.array(mode.A.floats()) for mode in system.modes}
    for name, count in done.evidence.steps:
        whole = np.linalg.matrix_power(matrices[name], int(count)) @ whole
    assert np.abs(np.linalg.eigvals(whole)).max() > 1
    assert keeps_turns(system.clock, done.evidence.steps)
