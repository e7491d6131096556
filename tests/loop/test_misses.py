"""Loops that miss deadlines: verdicts known by hand, and by every word of a window."""

from fractions import Fraction
from itertools import product

import pytest

from nrs_design.loop.assemble import assemble_matrices
from nrs_design.search.certify import certify
from nrs_design.spec import parse_spec

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


@pytest.mark.parametrize(
    ("most", "of", "stable"),
    [(1, 2, False), (1, 3, True), (2, 5, True), (2, 4, False), (3, 9, True)],
)
def test_one_state_decides_by_hand(most, of, stable):
    """0.5 and 2.5: as many misses as allowed in every window, so 0.5^(of - most) 2.5^most."""
    assert (0.5 ** (of - most) * 2.5**most < 1) is stable
    found = certify(system([[0.5]], [[2.5]], most, of))
    assert found.verdict == ("proved" if stable else "refuted")
    if stable:
        exact = (0.5 ** (of - most) * 2.5**most) ** (1 / of)
        assert exact <= float(found.evidence.proved_rate(found.system)) <= exact * 1.01
