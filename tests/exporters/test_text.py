"""Names, numbers and comments of exported C."""

import re
from fractions import Fraction

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from nrs_design.controllers.float32 import round_float32
from nrs_design.exporters.formats.c import header_text
from nrs_design.exporters.program import Program
from nrs_design.exporters.text import CNames, block_comment, literal
from tests.exporters.programs import LAWS

NAMES = st.from_regex("[a-z0-9][a-z0-9._-]{0,63}", fullmatch=True)


@pytest.mark.slow
@given(NAMES)
def test_every_name_of_a_spec_gives_identifiers(name):
    names = CNames(name)
    assert re.fullmatch("nrs_[a-z0-9_]+", names.lower)
    assert names.upper == names.lower.upper()
    assert re.fullmatch("NRS_[A-Z0-9_]+_MODE_A_B", names.mode("a.b"))


def test_every_number_of_a_law_has_a_macro_of_its_own(sampled_export):
    law = LAWS["static, filter, spring"]
    text = header_text(Program(sampled_export.record, law, CNames("x")))
    lines = re.findall(r"#define (\w+) (\S+)", text)
    numbers = dict(lines)
    assert len(numbers) == len(lines)
    coefficients = [value for c in law.coefficients for value in c.values]
    limits = [value.limit for value in law.values]
    wanted = ["2U", "0U", "1U", *map(literal, [*coefficients, *limits])]
    assert sorted(numbers.values()) == sorted(wanted)
    assert numbers["NRS_X_MODE_WITHDRAWAL"] == "1U"
    assert numbers["NRS_X_KT_OF_INSERTION"] == literal(Fraction(1, 2))
    assert {"NRS_X_KP", "NRS_X_T", "NRS_X_MAX_ANGLE"} < set(numbers)


@pytest.mark.parametrize(
    ("value", "text"),
    [(0, "0x0.0p+0F"), (1, "0x1.0p+0F"), (Fraction(-3, 2), "(-0x1.8p+0F)"), (4000, "0x1.f4p+11F")],
)
def test_literals_that_are_known(value, text):
    assert literal(Fraction(value)) == text


@given(st.floats(width=32, allow_nan=False, allow_infinity=False))
def test_literals_are_exact(value):
    text = literal(Fraction(value))
    assert Fraction(float.fromhex(text.strip("()").removesuffix("F"))) == Fraction(value)
    assert text.strip("()").endswith("F")
    assert round_float32(Fraction(value)) == Fraction(value)


@pytest.mark.slow
@example("???/ */*/ /*")
@given(st.text())
def test_no_text_ends_a_comment(text):
    """Nor begins one, nor is more than ASCII, nor a trigraph."""
    block = block_comment([text], b"/* first\n")
    assert block.count("*/") == 1
    assert block.endswith(" */\n")
    assert block.count("/*") == 1
    assert block.isascii()
    assert "??" not in block
    assert all(c == "\n" or " " <= c <= "~" for c in block)
