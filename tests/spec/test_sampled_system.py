"""Sampled loops of given matrices: what is read, and what is refused with what to write instead."""

from fractions import Fraction

import pytest

from nrs_design.spec import parse_spec
from nrs_design.spec.describe import describe
from nrs_design.spec.plausible import doubt_sizes
from tests.spec.samples import assert_refused, spoiled

TEXT = """\
kind: sampled-system
name: loop
plant:
  A: [[0, 1], [0, "-0.1"]]
  B: [[0], ["0.1"]]
  C: [[1, 0]]
controller: {A: [["1/2"]], B: [[1]], C: [[-2]], D: [[-3]]}
sampling:
  period: [8 ms, 12 ms]
  delay: [0 ms, 3 ms]
"""
GAIN = spoiled(TEXT, '{A: [["1/2"]], B: [[1]], C: [[-2]], D: [[-3]]}', "{K: [[-3]]}")


def test_what_is_read():
    spec = parse_spec(TEXT)
    assert spec.sampling.periods == (Fraction(1, 125), Fraction(3, 250))
    assert spec.sampling.delays == (0, Fraction(3, 1000))
    assert (spec.plant.states, spec.plant.inputs, spec.plant.outputs) == (2, 1, 1)
    # The plant counts twice where commands are late.
    assert (spec.states, parse_spec(GAIN).states) == (6, 5)
    at_once = parse_spec(spoiled(GAIN, "  delay: [0 ms, 3 ms]\n", ""))
    assert (at_once.sampling.delays, at_once.states) == ((0, 0), 3)
    assert (str(spec.sampling), str(at_once.sampling)) == (
        "period 8 ms to 12 ms, delay 0 ms to 3 ms",
        "period 8 ms to 12 ms",
    )
    constant = parse_spec(spoiled(GAIN, "[8 ms, 12 ms]", "10 ms"))
    assert constant.sampling.periods == (Fraction(1, 100), Fraction(1, 100))


def test_times_of_given_matrices_are_not_doubted():
    """A plant may be of any speed."""
    slow = GAIN.replace("[8 ms, 12 ms]", "[100 s, 2000 s]").replace("3 ms", "90 s")
    assert [*doubt_sizes(parse_spec(slow))] == []


def test_what_a_spec_lists():
    lines = {line.name: (line.written, line.value) for line in describe(parse_spec(TEXT))}
    assert lines["plant.B"] == ("", "2 x 1")
    assert lines["controller.D"] == ("", "1 x 1")
    assert lines["sampling.delay"] == ("[0 ms, 3 ms]", "")


def test_other_longest_times():
    timing = parse_spec(TEXT).sampling
    longer = timing.with_longest(Fraction(1, 50), Fraction(1, 500))
    assert (longer.periods, longer.delays) == (
        (Fraction(1, 125), Fraction(1, 50)),
        (0, Fraction(1, 500)),
    )
    shorter = timing.with_longest(Fraction(1, 200), Fraction(0))
    assert (shorter.periods, shorter.delays) == ((Fraction(1, 200),) * 2, (0, 0))


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("[8 ms, 12 ms]", "[0 ms, 12 ms]", "a period of zero is no time between two samples"),
        ("[8 ms, 12 ms]", "0 ms", "feedback without sampling is a switched-system"),
        ("[8 ms, 12 ms]", "[12 ms, 8 ms]", "the range of the times ends below its start"),
        ("[8 ms, 12 ms]", "[-8 ms, 12 ms]", "must be zero or positive"),
        ("[8 ms, 12 ms]", "[8 ms, 5000 s]", "write the matrices in another unit of time"),
        ("[8 ms, 12 ms]", "{range: [8 ms, 12 ms], varies: false}", "write [shortest, longest]"),
        ("[0 ms, 3 ms]", "[0 ms, 9 ms]", "a delay of 9 ms is longer than the shortest period, 8"),
        ("[0 ms, 3 ms]", "[0 ms, 9 ms]", "is not modelled where periods vary"),
        ("[0 ms, 3 ms]", "3", "3 s"),
        ('[0, "-0.1"]]', '[0, "-0.1"], [1, 1]]', "the matrix is 3 x 2, not square"),
        ('[[0], ["0.1"]]', "[[1]]", "the matrix has 1 rows, and the plant has 2 states"),
        ("[[1, 0]]", "[[1]]", "the matrix has 1 columns, and the plant has 2 states"),
        ("[[-3]]", "[[-3, 1]]", "the matrix is 1 x 2, expected 1 x 1"),
        ("{K: [[-3]]}", "{K: [[-3]], D: [[1]]}", "write K alone, or A, B and C"),
        ("{K: [[-3]]}", "{A: [[1]], B: [[1]]}", "write K alone, or A, B and C"),
        ("{K: [[-3]]}", "{}", "a controller is a gain, or has states"),
    ],
)
def test_what_is_refused(old, new, said):
    assert_refused(spoiled(GAIN, old, new), said)


@pytest.mark.parametrize(
    ("delay", "waiting", "rest"),
    [
        ("[0 ms, 10 ms]", 0, (0, 10)),
        ("[4 ms, 4 ms]", 0, (4, 4)),
        ("10 ms", 1, (0, 0)),
        ("[23 ms, 30 ms]", 2, (3, 10)),
    ],
)
def test_delays_of_whole_periods(delay, waiting, rest):
    text = spoiled(GAIN, "[8 ms, 12 ms]", "10 ms")
    spec = parse_spec(spoiled(text, "[0 ms, 3 ms]", delay))
    assert spec.sampling.waiting == waiting
    assert tuple(1000 * end for end in spec.sampling.rests) == rest
    assert spec.states == 3 + waiting + 2 * (rest[1] > 0)


@pytest.mark.parametrize(
    ("delay", "said"),
    [
        ("[5 ms, 15 ms]", "delays from 5 ms to 15 ms are not all between two whole numbers of"),
        ("700 ms", "a delay of 700 ms is 70 whole periods, at most 64 are read"),
    ],
)
def test_delays_that_are_refused(delay, said):
    text = spoiled(GAIN, "[8 ms, 12 ms]", "10 ms")
    assert_refused(spoiled(text, "[0 ms, 3 ms]", delay), said)


def test_at_most_64_states():
    n = 32
    rows = ", ".join(f"[{', '.join('0' * n)}]" for _ in range(n))
    text = spoiled(GAIN, '[[0, 1], [0, "-0.1"]]', f"[{rows}]")
    text = spoiled(text, '[[0], ["0.1"]]', f"[{', '.join(['[1]'] * n)}]")
    text = spoiled(text, "[[1, 0]]", f"[[{', '.join('1' * n)}]]")
    assert_refused(text, "the loop has 65 states, at most 64 are read")
    assert parse_spec(spoiled(text, "[0 ms, 3 ms]", "0 ms")).states == n + 1
