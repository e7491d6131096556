"""Records of the thesis: each has its run, and beside it what goes in and what is printed."""

import numpy as np
import pytest
from matplotlib.figure import Figure

from nrs_design.thesis import figures
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
    (row,) = [row for row in topic_rows("runs") if "X_i the reference" in row.name]
    assert by_run["figure-6-26-p"]["torque"][by_run["figure-6-26-p"].t < 25].max() == pytest.approx(
        float(row.value.split(",")[0]), rel=1e-3
    )
