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
from tests.tables import rows


def row(verdict, printed, found, /, **options):
    tolerance = options.pop("tolerance", Tolerance())
    given = {"relative": tolerance.relative, "absolute": tolerance.absolute, **options}
    return judge(PrintedRow(verdict, "quantity", "1.1", printed, "s", **given), found)


def confirm(printed, value, tolerance, **options):
    return row("reproduced", printed, value, tolerance=tolerance, **options)


def computed(found):
    """Return what a row says is found: numbers, a complex one as text, or what no longer holds."""
    match found:
        case str():
            return complex(found)
        case {"no longer": value}:
            return Recomputed(value, is_confirmed=False)
    return tuple(found) if isinstance(found, list) else found


@pytest.mark.parametrize(
    ("called", "printed", "found", "options", "verdict"), rows(__file__, "test_verdicts")
)
def test_verdicts(called, printed, found, options, verdict):
    printed = tuple(printed) if isinstance(printed, list) else printed
    assert row(called, printed, computed(found), **options).verdict == verdict


def test_words_in_print_have_no_deviation():
    found = confirm("Hurwitz", (-1.0, -2.0), Tolerance(1e-3), right=("-1", "-2"))
    assert (found.verdict, found.deviation, found.printed) == ("reproduced", None, "Hurwitz")


@pytest.mark.parametrize("verdict", ["printed differently", "derived", "reproduced"])
def test_words_that_no_longer_hold_are_a_drift(verdict):
    for found in (True, Recomputed("v"), "v"):
        kept = row(verdict, "p", found, value="v")
        assert (kept.verdict, kept.value, kept.deviation) == (verdict, "v", None)
    for found in (False, Recomputed("v", is_confirmed=False)):
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
    rows(__file__, "test_the_standard_is_a_part_in_a_thousand_or_the_last_digit"),
)
def test_the_standard_is_a_part_in_a_thousand_or_the_last_digit(value, printed, meets):
    value = complex(value) if isinstance(value, str) else value
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
