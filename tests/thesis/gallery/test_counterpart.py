import pytest

from nrs_design.thesis.gallery.counterpart import (
    Counterpart,
    Reproducibility,
    measured,
    stated,
    taken,
)


@pytest.mark.parametrize(
    ("value", "outcome"),
    [
        (1.0499, Reproducibility.REPRODUCED),
        (0.951, Reproducibility.REPRODUCED),
        (1.051, Reproducibility.NOT_REPRODUCED),
        (0.949, Reproducibility.NOT_REPRODUCED),
        (-1.0, Reproducibility.NOT_REPRODUCED),
    ],
)
def test_a_measurement_is_met_within_five_percent(value, outcome):
    found = measured("x", "1.0", value, "because")
    assert found.outcome is outcome
    assert found.why == ("" if outcome is Reproducibility.REPRODUCED else "because")


def test_an_omitted_input_is_never_a_reproduction():
    found = measured("x", "2", 2.0, "the speed is not printed", Reproducibility.OMITTED)
    assert (found.outcome, found.why) == (Reproducibility.OMITTED, "the speed is not printed")
    assert found.simulated == "2 (+0 %)"


def test_deviations_are_shown_in_percent_or_in_times():
    assert measured("x", "0.75", 0.0558, "w").simulated == "0.0558 (-93 %)"
    assert measured("x", "2", 11.84, "w").simulated == "11.84 (5.9 times)"


def test_words_and_inputs():
    assert stated("x", "less", "less", holds=True, why="w").why == ""
    assert (
        stated("x", "less", "more", holds=False, why="w").outcome is Reproducibility.NOT_REPRODUCED
    )
    assert taken("x", "15", 15.0).outcome is Reproducibility.TAKEN


@pytest.mark.parametrize(
    ("figures", "name"),
    [
        ((), "Section 7.2.2, without a figure"),
        (("6.14",), "Figure 6.14"),
        (("6.23", "6.24"), "Figures 6.23 and 6.24"),
        (("6.28", "6.29", "6.30"), "Figures 6.28 to 6.30"),
    ],
)
def test_names(figures, name):
    assert Counterpart(dict.fromkeys(figures, ""), "7.2.2", "", (), ()).name == name
