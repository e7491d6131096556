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


@pytest.mark.parametrize(
    ("old", "new", "at", "said"),
    [
        ("-2 - k, -1", "-2 - q, -1", "-2 - q", "there is no parameter of that name"),
        ("-2 - k, -1", "-2 - K, -1", "-2 - K", "did you mean k?"),
        ("-2 - k, -1", "-2 - k*m, -1", "-2 - k*m", "it multiplies k by m"),
        ("-2 - k, -1", "1/m, -1", "1/m", "a parameter of its own, with its own range"),
        ("nominal: 43", "nominal: 91", "91", "nominal 91 is outside the range [25, 90]"),
        ("nominal: 43", "nominal: 24.9", "24.9", "is outside the range [25, 90]"),
        ("[25, 90]", "[90, 25]", "[90, 25]", "below its start 90"),
        ("[25, 90]", "[25]", "[25]", "write [lowest, highest]"),
        ("[25, 90]", "[25, 43, 90]", "[25, 43", "write [lowest, highest]"),
        ("[25, 90]", "90", "90}", "write [lowest, highest]"),
        ("[25, 90]", "[25, m]", "m]", "not a number"),
        ("[25, 90]", "[25, [90]]", "[90]", "single value"),
        ("[25, 90]", "[25, 1e31]", "1e31", "beyond +-1e30"),
        ("[25, 90]", "[.nan, 90]", ".nan", "not a finite number"),
        ("nominal: 43, ", "", "{range: [25", "`parameters.k.nominal` is missing"),
        ("nominal: 43", "nomial: 43", "nomial", "did you mean nominal?"),
        ("nominal: 43", "nominal: 43 N", "43 N", "not a number"),
        ("varies: false", "varies: no", "no}", "write true or false"),
        ("varies: false", "varies: 0", "0}", "write true or false"),
        ("varies: false", "vary: false", "vary", "did you mean varies?"),
        ("  k:", "  2k:", "2k", "not a name of a parameter"),
        ("  k:", "  k-1:", "k-1", "not a name of a parameter"),
        ("  k:", "  κ:", "κ", "not a name of a parameter"),
        ("  k:", f"  {'k' * 33}:", "kk", "not a name of a parameter"),
        ("  k:", "  Inf:", "Inf", "reserved word"),
        ("  k:", "  on:", "on: {", "reserved word"),
        ("  k:", "  q: {nominal: 1}\n  k:", "{nominal: 1}", "no matrix depends on this"),
        ("{nominal: 43, range: [25, 90]}", "43", "43\n", "expected a mapping, not"),
    ],
)
def test_refuses_with_place_and_remedy(old: str, new: str, at: str, said: str) -> None:
    assert_refused(spoiled(SAMPLE, old, new), said, at)


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
