"""The page of a robot, on that of the thesis."""

from __future__ import annotations

import pytest

from nrs_design.reporting import render_html
from nrs_design.reporting.document import Illustration, Paragraph
from nrs_design.robot.models.correction import thesis_tilts
from nrs_design.robot.pipeline import run_robot
from nrs_design.robot.reporting.robot import robot_report
from tests.support import ROOT, document_of, thinned

ROBOT = ROOT / "specs" / "robots" / "neuroboscope.nrs.yaml"


@pytest.fixture(scope="module", params=thinned([15, 1], 1), ids=lambda every: f"every {every} deg")
def robot_page(request):
    """The page, which takes seconds to compute; its command is given this one.

    The correction is drawn over fewer tilts by default, which nothing here looks at.
    """
    with pytest.MonkeyPatch.context() as patch:
        tilts = thesis_tilts()[:: request.param]
        patch.setattr("nrs_design.robot.reporting.robot.thesis_tilts", lambda: tilts)
        return robot_report(*run_robot(ROBOT))


def blocks(report, kind):
    return [b for section in report.sections for b in section.blocks if isinstance(b, kind)]


def test_its_figures_and_lights(robot_page):
    assert [item.name for item in blocks(robot_page, Illustration)] == [
        "workspace", "torque-shares", "correction", "balance",
    ]  # fmt: skip
    assert [(light.name, str(light.state)) for light in robot_page.lights] == [
        ("Reach", "bad"),
        ("Singular poses", "good"),
        ("Balance", "good"),
    ]
    assert not [b for b in blocks(robot_page, Paragraph) if b.text.startswith("Not computed")]


@pytest.mark.slow
def test_the_same_robot_gives_the_same_bytes(robot_page):
    text = render_html(robot_page)
    assert text == render_html(robot_page)
    assert "Passive balance" in text


def test_unreachable_corners_are_said_with_the_exit_code_of_the_check(
    robot_page, tmp_path, monkeypatch
):
    """Thesis table 3.2 asks for 250 mm at all angles; two corners end at 244.4 mm."""

    def made_before(*given):
        assert repr(given) == repr((*run_robot(ROBOT), None))
        return robot_page

    monkeypatch.setattr("nrs_design.robot.reporting.robot.robot_report", made_before)
    found = document_of("report", ROBOT, cwd=tmp_path, code=1)
    assert found["verdict"] == "unreachable"
    text = (tmp_path / found["files"][0]).read_text(encoding="utf-8")
    assert "the left leg is overstretched" in text
    assert "244.4" in text
