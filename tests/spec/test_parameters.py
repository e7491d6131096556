"""Parameters of a switched-system spec."""

from fractions import Fraction

import pytest

from .samples import assert_refused, refusal, spoiled, switched

SAMPLE = """\
kind: switched-system
name: sample
time: continuous
parameters:
  k: {nominal: 43, range: [25, 90]}
  m: {nominal: 1, range: ["1/2", 2], varies: false}
modes:
  - {name: a, A: [[0, 1], [-2 - k, -1]]}
  - {name: b, A: [[0, 1], ["-(3/4*k - m + 0.5)", -1]]}
switching: arbitrary
"""


def test_reads_parameters_and_entries() -> None:
    spec = switched(SAMPLE)
    k, m = spec.parameters["k"], spec.parameters["m"]
    assert (k.nominal, k.range, k.varies, k.fixed) == (43, (25, 90), True, False)
    assert (m.nominal, m.range, m.varies) == (1, (Fraction(1, 2), 2), False)
    a, b = spec.modes
    assert (a.parameters, b.parameters) == ({"k"}, {"k", "m"})
    assert a.matrix({"k": Fraction(1, 2)}) == [[0, 1], [Fraction(-5, 2), -1]]
    values = {"k": Fraction(4), "m": Fraction(1)}
    assert b.matrix(values) == [[0, 1], [Fraction(-5, 2), -1]]


def test_without_a_range_it_is_a_constant() -> None:
    spec = switched(spoiled(SAMPLE, "{nominal: 43, range: [25, 90]}", "{nominal: 43}"))
    assert spec.parameters["k"].range == (43, 43)
    assert spec.parameters["k"].fixed


def test_a_matrix_needs_the_value_of_every_parameter() -> None:
    with pytest.raises(KeyError):
        switched(SAMPLE).modes[1].matrix({"k": Fraction(1)})


def test_parameters_are_a_mapping() -> None:
    head, _, tail = SAMPLE.partition("parameters:")
    text = f"{head}parameters: [k]\nmodes:{tail.partition('modes:')[2]}"
    assert "expected a mapping, not" in refusal(text).message


def test_the_number_of_parameters_is_limited() -> None:
    names = [f"p{i}" for i in range(17)]
    listing = "".join(f"  {name}: {{nominal: 0, range: [-1, 1]}}\n" for name in names)
    text = (
        "kind: switched-system\nname: a\ntime: discrete\nswitching: arbitrary\n"
        f"parameters:\n{listing}modes:\n  - {{name: a, A: [[{' + '.join(names)}]]}}\n"
    )
    assert "parameters: more than" in refusal(text).message
    fewer = text.replace("  p16: {nominal: 0, range: [-1, 1]}\n", "").replace(" + p16", "")
    assert_refused(fewer, "65536 corners in all, at most 20000", "parameters:")


def test_a_dwell_time_needs_constant_matrices() -> None:
    text = spoiled(SAMPLE, "switching: arbitrary", "switching: {dwell_time: 1 s}")
    assert_refused(text, "the range of parameter 'k' exclude each other", "1 s}")
    point = text.replace("range: [25, 90]", "range: [43, 43]").replace('["1/2", 2]', "[1, 1]")
    assert switched(point).switching.dwell_time is not None
