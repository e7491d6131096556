"""Every figure from 6.14 to 6.34 has its counterpart, with what the thesis prints of it."""

import re

import pytest

from nrs_design.thesis import runs
from nrs_design.thesis.gallery.counterpart import Reproducibility
from nrs_design.thesis.gallery.figures import TOPICS, draw_counterparts

# Typed from the text of 6.3.1.2, 6.3.2.3, 6.3.3.1, 6.3.3.3 and 6.4.2, one line for each figure.
PRINTED = {
    "6.14": ("15", "2.1372", "2.0997", "2.1766", "0.0595"),
    "6.15": ("5.3", "2.0494", "2.0883", "2.1131", "0.0444"),
    "6.18": ("0.75", "0.61", "19"),
    "6.19": ("0.53", "0.41", "21"),
    "6.20": ("0.09", "0.07", "20"),
    "6.21": ("0.16", "0.13", "20"),
    "6.25": ("0.707", "40.2971"),
    "6.26": ("19", "52", "0.35", "2"),
    "6.27": ("14.5", "53.5", "12"),
    "6.33": ("2", "18", "20.9", "0.12335", "0.4621"),
    "6.34": ("6.7", "31.7", "37.8", "0.5333", "0.17"),
}
NUMBER = re.compile(r"\d+(\.\d+)?")


@pytest.mark.slow
def test_every_figure_has_one_counterpart(counterparts):
    figures = [figure for one in counterparts for figure in one.shows]
    assert figures == [f"6.{number}" for number in range(14, 35)]


def test_every_counterpart_is_drawn_and_says_what_went_in(counterparts):
    for one in counterparts:
        assert one.illustrations, one.name
        assert one.given, one.name
        assert one.statements, one.name
    names = [item.name for one in counterparts for item in one.illustrations]
    assert len(set(names)) == len(names)


@pytest.mark.parametrize("figure", PRINTED)
def test_printed_numbers_are_those_of_the_thesis_and_no_others(by_figure, figure):
    printed = [s.printed for s in by_figure[figure].statements]
    assert tuple(text for text in printed if NUMBER.fullmatch(text)) == PRINTED[figure]


def test_other_figures_have_no_printed_numbers(counterparts):
    for one in counterparts:
        if one.shows and not set(one.shows) & set(PRINTED):
            assert not any(NUMBER.fullmatch(s.printed) for s in one.statements), one.name


def test_whatever_is_not_reproduced_says_why(counterparts):
    for one in counterparts:
        for statement in one.statements:
            assert statement.why or statement.outcome is Reproducibility.REPRODUCED, statement


def test_an_instant_that_was_put_in_comes_out(counterparts):
    """The run is where the thesis was, to the digit that is printed."""
    taken = [
        s for one in counterparts for s in one.statements if s.outcome is Reproducibility.TAKEN
    ]
    assert len(taken) == 12
    for statement in taken:
        unit = 10.0 ** -len(statement.printed.partition(".")[2])
        assert abs(float(statement.simulated) - float(statement.printed)) < unit / 2, statement


def simulated(one, quantity):
    (statement,) = [s for s in one.statements if s.quantity.startswith(quantity)]
    return statement.simulated


def test_at_rest_the_robot_displays_its_damping(by_figure):
    for figure in ("6.14", "6.15"):
        shown = [s for s in by_figure[figure].statements if s.quantity.startswith("displayed")]
        assert [s.simulated.partition(" ")[0] for s in shown] == ["2.15"] * 3
        assert {s.outcome for s in shown} == {Reproducibility.REPRODUCED}


def test_withdrawals_are_those_of_the_table(by_figure):
    rows = [row for row in runs.rows() if row.name.startswith("withdrawal time")]
    for figure, row in zip(("6.18", "6.19", "6.20", "6.21"), rows * 2, strict=True):
        found = [
            float(simulated(by_figure[figure], quantity).partition(" ")[0])
            for quantity in ("time without", "time with ", "gain")
        ]
        assert found == pytest.approx(list(map(float, row.value.split(", "))), rel=1e-3)


def test_the_limit_is_that_of_the_closed_form(by_figure):
    """Peak and error of 6.41 at 5 deg/s, as in the rows of the table: 0.3477 N m and 11.84 %."""
    one = by_figure["6.26"]
    assert simulated(one, "largest torque") == "0.3477 (-0.66 %)"
    assert simulated(one, "steady-state error") == "11.84 (5.9 times)"
    assert simulated(by_figure["6.27"], "steady-state error").startswith("11.84 ")
    pi = simulated(one, "an integral")
    assert pi.startswith("PI that bleeds: 0 % left")


def test_the_axes_of_one_model_cannot_both_be_right(by_figure):
    """The thesis sees the overshoot in phi and none in psi."""
    outcomes = [
        next(s.outcome for s in by_figure[figure].statements if s.quantity.startswith("overshoot"))
        for figure in ("6.26", "6.27")
    ]
    assert outcomes == [Reproducibility.REPRODUCED, Reproducibility.NOT_REPRODUCED]


def test_the_six_moves_have_a_sign_for_each_pair(counterparts):
    hands = counterparts[-1]
    assert not hands.shows
    changes = [s for s in hands.statements if s.quantity.startswith("change")]
    assert [s.printed for s in changes] == [
        *("-6", "-5", "-2", "-2", "-35", "-33", "-30"),
        *("+4", "+7", "+1", "approximately the same", "+97", "+92", "+79"),
    ]
    assert {s.outcome for s in changes} == {Reproducibility.OMITTED}
    assert [s.outcome for s in hands.statements[:2]] == [Reproducibility.REPRODUCED] * 2


def test_progress_names_every_topic(monkeypatch):
    from nrs_design.thesis.gallery import figures

    monkeypatch.setattr(figures, "TOPICS", [(topic, tuple) for topic, _ in TOPICS])
    told: list[str] = []
    assert draw_counterparts(told.append) == ()
    assert told == [topic for topic, _ in TOPICS]
