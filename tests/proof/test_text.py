"""Exact numbers as words."""

from fractions import Fraction

import pytest

from nrs_design.proof.text import counted, exact_text, quoted


def test_one_is_singular():
    assert [counted(number, "reset") for number in (0, 1, 2)] == ["0 resets", "1 reset", "2 resets"]
    assert [counted(number, "switch") for number in (1, 2)] == ["1 switch", "2 switches"]


@pytest.mark.parametrize(
    ("number", "text"),
    [
        (Fraction(5), "5"),
        (Fraction(1, 8), "0.125"),
        (Fraction(1, 3), "1/3"),
        (Fraction(10) ** 400, "1" + "0" * 400),
        (-(Fraction(10) ** 400), "-1" + "0" * 400),
    ],
)
def test_a_number_is_written_exactly(number, text):
    assert exact_text(number) == text
    assert Fraction(text) == number


def test_foreign_text_is_short_and_harmless():
    assert quoted("a\x1b[2J") == repr("a\x1b[2J")
    assert quoted("x" * 40) == repr("x" * 40)
    assert quoted("x" * 41) == quoted("x" * 1000) == repr("x" * 37 + "...")
