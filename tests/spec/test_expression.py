import re
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.spec.expression import MAX_LENGTH, Affine, parse_affine
from tests.tables import rows

from .samples import message_of

NAMES = ("k", "m", "r2", "B_t")


@pytest.mark.parametrize(("text", "constant", "slopes"), rows(__file__, "test_reads_exactly"))
def test_reads_exactly(text: str, constant: int | str, slopes: dict[str, int | str]) -> None:
    expected = tuple(sorted((name, Fraction(value)) for name, value in slopes.items()))
    assert parse_affine(text) == Affine(Fraction(constant), expected)


fractions = st.fractions(-1000, 1000, max_denominator=50)
points = st.fixed_dictionaries(dict.fromkeys(NAMES, fractions))


def written(number: Fraction) -> str:
    return f"({number})"


def affine_texts(constant: bool) -> st.SearchStrategy[str]:
    leaves = st.builds(written, fractions)
    if not constant:
        leaves = leaves | st.sampled_from(NAMES)
    numbers = st.builds(written, fractions)
    nonzero = st.builds(written, fractions.filter(bool))
    return st.recursive(
        leaves,
        lambda inner: st.one_of(
            st.builds("{} + {}".format, inner, inner),
            st.builds("({}) - ({})".format, inner, inner),
            st.builds("{}*({})".format, numbers, inner),
            st.builds("({}) * {}".format, inner, numbers),
            st.builds("({})/{}".format, inner, nonzero),
            st.builds("-({})".format, inner),
        ),
        max_leaves=6,
    ).filter(lambda text: len(text) <= MAX_LENGTH)


def evaluated(text: str, values: dict[str, Fraction]) -> Fraction:
    """Evaluate a text of our own making, whose numbers are made fractions."""
    exact = re.sub(r"(?<![A-Za-z_])\d+", r"Fraction(\g<0>)", text)
    found: Fraction = eval(exact, {"Fraction": Fraction}, values)
    return found


@given(affine_texts(constant=False), points)
def test_agrees_with_rational_arithmetic(text: str, values: dict[str, Fraction]) -> None:
    assert parse_affine(text).at(values) == evaluated(text, values)


@given(st.text(max_size=250) | st.text("km()+-*/^. 0129eE_", max_size=60))
def test_garbage_is_refused_and_never_evaluated(text: str) -> None:
    found: list[Affine] = []
    message = message_of(lambda: found.append(parse_affine(text)))
    # Anything but a SpecError passes through and fails this test.
    assert bool(message) != bool(found)
    assert all(slope for function in found for _, slope in function.slopes)


def test_equal_functions_are_equal() -> None:
    assert parse_affine("m + k - 1") == parse_affine("-(1 - k) + m")
    assert parse_affine("k").plus(parse_affine("-k")).is_constant
