import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.reproduction.comparison import (
    PrintVerdict,
    Tolerance,
    claim,
    drifted,
    format_number,
    hardware_only,
    misprint,
    omitted,
    reproduced,
)


def confirm(printed, value, tolerance, **options):
    return reproduced("quantity", "1.1", printed, value, "s", tolerance, **options)


def correct(printed, value, tolerance, right):
    return misprint("quantity", "1.1", printed, value, "s", tolerance, right=right, note="why")


@pytest.mark.parametrize(
    ("value", "verdict"), [(2.002, "reproduced"), (2.004, "drift"), (math.nan, "drift")]
)
def test_reproduced_only_within_the_tolerance(value, verdict):
    assert confirm("2", value, Tolerance(relative=1.5e-3)).verdict == verdict


def test_tolerance_holds_entry_by_entry():
    # 0.2 of 1 is far off, however large the other entry is.
    assert confirm(("1", "1000"), (1.2, 1000.0), Tolerance(1e-2)).verdict == "drift"
    assert confirm(("1", "1000"), (1.001, 1005.0), Tolerance(1e-2)).verdict == "reproduced"


def test_tolerance_is_about_the_right_value_where_one_is_given():
    assert confirm("2.15", 2.1514, Tolerance(absolute=1e-4), right="2.1514").verdict == "reproduced"
    assert confirm("2.15", 2.15, Tolerance(absolute=1e-4), right="2.1514").verdict == "drift"


def test_words_in_print_have_no_deviation():
    row = confirm("Hurwitz", (-1.0, -2.0), Tolerance(1e-3), right=("-1", "-2"))
    assert (row.verdict, row.deviation, row.printed) == ("reproduced", None, "Hurwitz")


def test_misprint_needs_the_right_value():
    row = correct("3.7754", 3.74541, Tolerance(1e-4), "3.7454")
    assert row.verdict == "print is wrong"
    assert row.deviation == pytest.approx(0.0301 / 3.7754, rel=1e-2)
    assert correct("3.7754", 3.7554, Tolerance(1e-4), "3.7454").verdict == "drift"


def test_misprint_is_a_drift_if_the_print_is_right_after_all():
    assert correct("3.7454", 3.7454, Tolerance(1e-4), "3.7454").verdict == "drift"


def test_a_claim_that_no_longer_holds_is_a_drift():
    verdicts = [
        claim("q", "1", "p", "v", verdict=PrintVerdict.PRINT_IS_WRONG, holds=holds, note="").verdict
        for holds in (True, False)
    ]
    assert verdicts == ["print is wrong", "drift"]


def test_pairs_of_poles():
    row = confirm("-28.4900 +- 28.49861j", complex(-28.49, 28.4986), Tolerance(1e-5))
    assert row.verdict == "reproduced"
    assert row.value == "-28.49 +- 28.4986j"
    assert confirm("-28 +- 28j", complex(-28, 29), Tolerance(1e-2)).verdict == "drift"


def test_deviation_is_absolute_where_the_print_is_zero():
    assert confirm("0", 0.25, Tolerance(absolute=1)).deviation == 0.25


def test_values_of_other_length_drift():
    assert confirm(("1", "2"), (1.0,), Tolerance(1.0)).verdict == "drift"


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_no_deviation_that_json_cannot_hold(value):
    assert confirm("1", value, Tolerance(1e-3)).deviation is None


def test_value_shows_as_many_digits_as_the_print():
    assert confirm("117359.43", 117359.436, Tolerance(1e-5)).value == "117359.44"
    assert confirm("4.8417e-4", 4.8417237e-4, Tolerance(1e-4)).value == "0.000484172"


def test_nothing_is_computed_for_hardware_and_omitted_data():
    rows = hardware_only("q", "1", "20", "%"), omitted("q", "1", "20", "%", "no record")
    assert [row.verdict for row in rows] == ["hardware only", "needs data that the thesis omits"]
    assert [(row.value, row.deviation) for row in rows] == [(None, None)] * 2


def test_drifted_picks_the_drifts():
    good, bad = (confirm("1", value, Tolerance(1e-3)) for value in (1.0, 2.0))
    assert drifted((good, bad, good)) == (bad,)


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_number_text_is_close_to_the_number(value):
    assert float(format_number(value)) == pytest.approx(value, rel=1e-5)


@given(st.floats(1e-3, 1e3), st.floats(-0.2, 0.2))
def test_verdict_agrees_with_the_deviation(printed, relative):
    row = confirm(repr(printed), printed * (1 + relative), Tolerance(0.1))
    if abs(abs(relative) - 0.1) > 1e-9:
        assert (row.verdict == "reproduced") == (row.deviation < 0.1)
