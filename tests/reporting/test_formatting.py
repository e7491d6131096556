from math import pi

import pytest

from nrs_design.reporting.formatting import (
    drawable,
    list_first,
    number,
    polynomial_text,
    root,
    roots,
    wrapped_label,
)
from nrs_design.reporting.simulation import four_digits_up
from nrs_design.reporting.worst_case import scale_of
from tests.tables import rows


@pytest.mark.parametrize(("value", "text"), rows(__file__, "test_number"))
def test_number(value, text):
    assert number(value) == text


def test_pairs_are_written_once():
    assert root(3 - 4j) == "3 ± 4j"
    assert roots([-1 + 2j, -1 - 2j, -5 + 0j]) == "-1 ± 2j, -5"


def test_polynomial():
    assert polynomial_text((0.0351, 1.99, -56.82)) == "0.0351 s^2 + 1.99 s - 56.82"
    assert polynomial_text((0.0,)) == "0"


def test_lists():
    assert list_first(["a", "b", "c"], 2) == "a, b and 1 more"


@pytest.mark.parametrize(
    ("value", "text"), rows(__file__, "test_a_torque_above_its_limit_is_never_shown_at_it")
)
def test_a_torque_above_its_limit_is_never_shown_at_it(value, text):
    assert four_digits_up(value) == text


def test_drawable_has_letters_of_the_font_only():
    assert drawable("αβ שלום ≤ 中") == "αβ שלום ≤ \\u4e2d"


@pytest.mark.parametrize(
    ("text", "width", "lines"), rows(__file__, "test_wrapped_keeps_every_letter")
)
def test_wrapped_keeps_every_letter(text, width, lines):
    assert wrapped_label(text, width).split("\n") == lines


@pytest.mark.parametrize(
    ("name", "unit", "arm", "shown"),
    [
        ("force", "N*m", 0.24, (1.0, "N m")),
        ("velocity", "rad/s", None, (180 / pi, "deg/s")),
        ("deflection", "rad", 0.24, (240.0, "mm")),
        ("deflection", "rad", None, (180 / pi, "deg")),
        ("motor command", "rpm", 0.24, (1.0, "rpm")),
    ],
)
def test_units(name, unit, arm, shown):
    assert scale_of(name, unit, arm) == shown
