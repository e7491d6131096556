"""Records of the thesis: each has its run, and beside it what goes in and what is printed."""

import re

import numpy as np
import pytest
from matplotlib.figure import Figure

from nrs_design.thesis import figures, runs
from nrs_design.thesis.figures import draw_counterparts, gallery_page, summarize_gallery
from nrs_design.thesis.table import topic_rows


@pytest.fixture(scope="module")
def counterparts():
    """All runs with empty figures: drawing takes longer than all the rest."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(figures, "draw_panels", lambda columns: Figure())
        return draw_counterparts()


@pytest.fixture(scope="module")
def by_run(counterparts):
    return {name: run for one in counterparts for name, run in one.runs.items()}


def test_the_page_has_every_figure_and_input(counterparts):
    page = gallery_page(counterparts)
    assert page.startswith("<!DOCTYPE html>")
    assert "default-src 'none'" in page
    assert "http" not in page.replace("http-equiv", "")
    assert page.count('role="img"') == len(counterparts)
    for one in counterparts:
        assert all(f'<th scope="row">{figure}</th>' in page for figure in one.given["shows"])
        for text in (*one.given["printed"], *one.given["given"], *one.given["chosen"]):
            assert text.replace("'", "&#39;").replace("<", "&lt;") in page
    fields = summarize_gallery(counterparts)
    assert fields[0]["figures"] == ["6.14"]
    assert fields[0]["runs"] == ["figure-6-14.csv"]


def test_an_instant_that_was_put_in_comes_out(counterparts, by_run):
    """Contact is made where the thesis prints it, to its digit."""
    found = 0
    for one in counterparts:
        for column in one.given["columns"]:
            for instant in column.get("instants", ())[
                : 3 if one.given["section"] == "6.4.2" else 1
            ]:
                run = by_run[column["run"]]
                changed = np.flatnonzero(np.diff(run["depth"] > 0) | np.diff(run.mode) != 0)
                near = np.abs(run.t[changed] - instant).min()
                assert near < 0.06, (column, instant)
                found += 1
    assert found == 14


def test_at_rest_the_robot_displays_its_damping(counterparts, by_run):
    for one in counterparts[:2]:
        (column,) = one.given["columns"]
        run = by_run[column["run"]]
        for instant in column["instants"][1:]:
            hand, torque = (np.interp(instant, run.t, run[name]) for name in ("hand", "torque"))
            assert torque / hand == pytest.approx(2.15, rel=1e-3)


def test_the_limit_is_that_of_the_closed_form(by_run):
    """Peak of 6.41 at 5 deg/s, as in the rows of the table."""
    (row,) = [row for row in topic_rows(runs) if "X_i the reference" in row.name]
    assert by_run["figure-6-26-p"]["torque"][by_run["figure-6-26-p"].t < 25].max() == pytest.approx(
        float(row.value.split(",")[0]), rel=1e-3
    )


def test_printed_numbers_are_those_of_the_text(counterparts):
    """Typed from the text of 6.3.1.2, 6.3.2.3, 6.3.3.3 and 6.4.2."""
    said = {f: " ".join(one.given["printed"]) for one in counterparts for f in one.given["shows"]}
    for figure, numbers in {
        "6.14": "15 2.1372 2.0997 2.1766 0.0595",
        "6.15": "5.3 2.0494 2.0883 2.1131 0.0444",
        "6.18": "0.75 0.61 19 0.09 0.07 20",
        "6.19": "0.53 0.41 21 0.16 0.13 20",
        "6.26": "19 52 0.35 2",
        "6.27": "14.5 53.5 12",
        "6.33": "2 18 20.9 0.12335 0.4621",
        "6.34": "6.7 31.7 37.8 0.5333 0.17",
    }.items():
        assert set(numbers.split()) <= set(re.findall(r"\d+(?:\.\d+)?", said[figure])), figure
