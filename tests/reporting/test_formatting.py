from __future__ import annotations

import math

import pytest

from nrs_design.reporting.formatting import number, plural, polynomial_text, root, roots, shortened


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (5523.4, "5523"),
        (117359.4, "117400"),
        (0.01, "0.01"),
        (1e-7, "1e-07"),
        (math.inf, "unlimited"),
    ],
)
def test_number(value, text):
    assert number(value) == text


def test_pairs_are_written_once():
    assert root(3 - 4j) == "3 ± 4j"
    assert roots([-1 + 2j, -1 - 2j, -5 + 0j]) == "-1 ± 2j, -5"


def test_polynomial():
    assert polynomial_text((0.0351, 1.99, -56.82)) == "0.0351 s^2 + 1.99 s - 56.82"
    assert polynomial_text((0.0,)) == "0"


def test_lists():
    assert shortened(["a", "b", "c"], 2) == "a, b and 1 more"
    assert plural(1, "mode") == "1 mode"
    assert plural(2, "mode") == "2 modes"
