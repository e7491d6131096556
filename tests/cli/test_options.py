"""Times on a command line, with and without a unit."""

import pytest
import typer

from nrs_design.cli.options import seconds


@pytest.mark.parametrize(
    ("text", "value"), [("0.001", 0.001), ("1 ms", 0.001), ("2 s", 2.0), ("1e-3", 0.001)]
)
def test_a_number_and_a_unit_mean_the_same(text, value):
    assert seconds()(text) == pytest.approx(value)


@pytest.mark.parametrize("text", ["1 m", "1,5 ms", "soon", "nan", "-1", "-1 ms", ""])
def test_what_is_no_time_is_refused(text):
    with pytest.raises(typer.BadParameter):
        seconds()(text)


def test_a_time_out_of_range_says_the_range():
    with pytest.raises(typer.BadParameter, match=r"out of range: 0\.001 to 1 s"):
        seconds(1e-3, 1.0)("3 s")
