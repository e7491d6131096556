import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.thesis.comparison import (
    PrintedRow,
    Recomputed,
    Tolerance,
    compare_topic,
    format_number,
    judge,
    meets_standard,
)


def row(verdict, printed, found, /, **options):
    tolerance = options.pop("tolerance", Tolerance())
    given = {"relative": tolerance.relative, "absolute": tolerance.absolute, **options}
    return judge(PrintedRow(verdict, "quantity", "1.1", printed, "s", **given), found)


def confirm(printed, value, tolerance, **options):
    return row("reproduced", printed, value, tolerance=tolerance, **options)


THOUSANDTH = {"relative": 1e-3}
# What is printed, what is found, how far off it may be, and what it is then called.
VERDICTS = [
    ("reproduced", "2", 2.002, {"relative": 1.5e-3}, "reproduced"),
    ("reproduced", "2", 2.004, {"relative": 1.5e-3}, "drift"),
    ("reproduced", "2", math.nan, {"relative": 1.5e-3}, "drift"),
    # 0.2 of 1 is far off, however large the other entry is; and nothing replaces a missing one.
    ("reproduced", ("1", "1000"), (1.2, 1000.0), THOUSANDTH, "drift"),
    ("reproduced", ("1", "1000"), (1.0005, 1000.5), THOUSANDTH, "reproduced"),
    ("reproduced", ("1", "2"), (1.0,), {"relative": 1.0}, "drift"),
    ("reproduced", "-28 +- 28j", complex(-28, 29), {"relative": 1e-2}, "drift"),
    # A tolerance wider than the standard reproduces nothing, and a misprint within it is none.
    ("reproduced", "1.8318", 1.8229, {"relative": 1e-2}, "drift"),
    ("printed differently", "1.000", 1.0005, {"relative": 1e-5, "right": "1.0005"}, "drift"),
    ("printed differently", "3.7754", 3.7554, {"relative": 1e-4, "right": "3.7454"}, "drift"),
    (
        "printed differently",
        "3.7754",
        3.74541,
        {"relative": 1e-4, "right": "3.7454"},
        "printed differently",
    ),
    ("derived", "", 6.69, {"right": "6.8", "absolute": 0.2}, "derived"),
    ("derived", "", 6.5, {"right": "6.8", "absolute": 0.2}, "drift"),
    ("derived", "", Recomputed(6.8, holds=False), {"right": "6.8", "absolute": 0.2}, "drift"),
    # Near is neither reproduced nor far.
    *(
        ("not reproducible", "1.00", value, {"right": "1.05", "because": "why", "relative": 0.1}, v)
        for value, v in ((1.0, "drift"), (1.05, "not reproducible"), (1.2, "drift"))
    ),
]


@pytest.mark.parametrize(("called", "printed", "found", "options", "verdict"), VERDICTS)
def test_verdicts(called, printed, found, options, verdict):
    assert row(called, printed, found, **options).verdict == verdict


def test_words_in_print_have_no_deviation():
    found = confirm("Hurwitz", (-1.0, -2.0), Tolerance(1e-3), right=("-1", "-2"))
    assert (found.verdict, found.deviation, found.printed) == ("reproduced", None, "Hurwitz")


@pytest.mark.parametrize("verdict", ["printed differently", "derived", "reproduced"])
def test_words_that_no_longer_hold_are_a_drift(verdict):
    for found in (True, Recomputed("v"), "v"):
        kept = row(verdict, "p", found, value="v")
        assert (kept.verdict, kept.value, kept.deviation) == (verdict, "v", None)
    for found in (False, Recomputed("v", holds=False)):
        assert row(verdict, "p", found, value="v").verdict == "drift"


def test_deviation_is_absolute_where_the_print_is_zero():
    assert confirm("0", 0.25, Tolerance(absolute=1)).deviation == 0.25


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_no_deviation_that_json_cannot_hold(value):
    assert confirm("1", value, Tolerance(1e-3)).deviation is None


def test_value_shows_as_many_digits_as_the_print():
    assert confirm("117359.43", 117359.436, Tolerance(1e-5)).value == "117359.44"
    pair = confirm("-28.4900 +- 28.49861j", complex(-28.49, 28.4986), Tolerance(1e-5))
    assert (pair.verdict, pair.value) == ("reproduced", "-28.49 +- 28.4986j")
    assert confirm("4.8417e-4", 4.8417237e-4, Tolerance(1e-4)).value == "0.000484172"


def test_what_cannot_be_recomputed_says_why():
    found = row("not reproducible", "20", Recomputed(), because="there is no record")
    assert found.verdict == "not reproducible"
    assert (found.value, found.deviation, found.drift) == (None, None, None)
    assert found.note == "Not reproducible, because there is no record."


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_number_text_is_close_to_the_number(value):
    assert float(format_number(value)) == pytest.approx(value, rel=1e-5)


@pytest.mark.parametrize(
    ("value", "printed", "meets"),
    [
        (2.0021, "2.000", False),  # More than 0.1 %, and than 0.001.
        (2.0019, "2.000", True),
        (2.14, "2.1", True),
        (2.21, "2.1", False),
        (1.23e5, "1.2e5", True),
        (1.31e5, "1.2e5", False),
        (complex(-28.49, 28.49), "-28.4900 +- 28.49861j", True),
        (complex(-28.4, 28.49), "-28.4900 +- 28.49861j", False),
    ],
)
def test_the_standard_is_a_part_in_a_thousand_or_the_last_digit(value, printed, meets):
    assert meets_standard((value,), printed) == meets


def near(printed, value, right, tolerance):
    given = {"right": right, "because": "why", "tolerance": tolerance}
    return row("not reproducible", printed, value, **given)


def test_print_and_reference_are_two_things():
    """Far from the print and on our reference is no drift, and the other way about it is one."""
    found = near("2.0", 2.5, "2.5", Tolerance(1e-3))
    assert (found.verdict, found.deviation, found.precision) == ("not reproducible", 0.25, "0.1")
    assert (found.drift, found.limit) == (0.0, "0.1 %")
    assert near("2.0", 2.4, "2.5", Tolerance(1e-3)).verdict == "drift"
    found = confirm("2.15", 2.1514, Tolerance(absolute=1e-4), right="2.1514")
    assert (found.precision, found.drift, found.limit) == ("0.01", 0.0, "0.0001")


def test_precision_number_by_number():
    assert confirm(("1000", "2", "1000"), (1000.0, 2.0, 1000.0), Tolerance(1.0)).precision == (
        "0.1 %, 1"
    )


def test_what_is_fitted_names_its_constant():
    for value, verdict in ((1.0, "fitted"), (1.1, "drift")):
        found = row("fitted", "1.00", value, fitted="l0 = 200 mm", relative=1e-3)
        assert (found.verdict, found.fitted) == (verdict, "l0 = 200 mm")


def test_notes_have_computed_numbers():
    found = row("derived", "", Recomputed(1.0, facts=("2.5",)), right="1", note="It is {} s.")
    assert found.note == "It is 2.5 s."


def test_every_row_that_is_computed_has_a_result():
    with pytest.raises(ValueError, match="actuator: 1 results"):
        compare_topic("actuator", [1.0])


@pytest.mark.parametrize(
    ("tolerance", "text"),
    [(Tolerance(1e-3), "0.1 %"), (Tolerance(3e-5), "0.003 %"), (Tolerance(absolute=0.2), "0.2")],
)
def test_tolerance_in_words(tolerance, text):
    assert str(tolerance) == text
    assert confirm("2", 2.0, tolerance).limit == text
