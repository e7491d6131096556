"""`nrs-design mode-logic`, as a user types it, and what a proof makes of it."""

import pytest

from tests.support import FORCE_LIMIT, ROOT, run

BY_SIGN = ROOT / "docs/examples/insertion-by-sign.nrs.yaml"


def test_switches_and_times(tmp_path):
    result = run("mode-logic", BY_SIGN, cwd=tmp_path, code=0)
    assert "command below -0.5 deg/s and torque above 0.1 N*m" in result.stdout
    assert "torque ≤ 0.126401 N·m" in result.stdout
    assert "torque, from switch 1 to 3" in result.stdout
    assert "(band - 2 N)/R - D" in result.stdout


def test_a_spec_without_logic(tmp_path):
    assert "has no mode_logic" in run("mode-logic", FORCE_LIMIT, cwd=tmp_path, code=2).stderr


@pytest.mark.slow
def test_the_report_shows_it(tmp_path):
    run("report", BY_SIGN, "--out", "page.html", cwd=tmp_path, code=0)
    page = (tmp_path / "page.html").read_text()
    assert "Switches, in the order in which they are tried" in page
    assert "The dwell times are kept by the timer of the mode logic" in page
