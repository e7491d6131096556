"""`nrs-design mode-logic`, as a user types it, and what a proof makes of it."""

import pytest

from tests.support import FORCE_LIMIT, ROOT, document_of, run

BY_SIGN = ROOT / "docs/examples/insertion-by-sign.nrs.yaml"


def test_switches_and_times(tmp_path):
    result = run("mode-logic", BY_SIGN, cwd=tmp_path, code=0)
    assert "command below -0.5 deg/s and torque above 0.1 N*m" in result.stdout
    assert "torque ≤ 0.126401 N·m" in result.stdout
    assert "torque, from switch 1 to 3" in result.stdout
    assert "(band - 2 N)/R - D" in result.stdout


def test_json(tmp_path):
    document = document_of("mode-logic", BY_SIGN, cwd=tmp_path)
    assert document["schema"] == "nrs-design/mode-logic/1"
    assert document["used_in_proof"] is True
    withdrawal = next(c for c in document["controllers"] if c["name"] == "withdrawal")
    assert withdrawal["stay"] == 0.00518
    assert [pair["at_least"] for pair in withdrawal["pairs"]] == [0.016, 0.00518032]


def test_a_spec_without_logic(tmp_path):
    assert "has no mode_logic" in run("mode-logic", FORCE_LIMIT, cwd=tmp_path, code=2).stderr


@pytest.mark.slow
def test_the_report_shows_it(tmp_path):
    run("report", BY_SIGN, "--out", "page.html", cwd=tmp_path, code=0)
    page = (tmp_path / "page.html").read_text()
    assert "Switches, in the order in which they are tried" in page
    assert "The dwell times are kept by the timer of the mode logic" in page


def test_the_torque_stays_below_the_limit_when_force_control_takes_over(tmp_path):
    """0.27 + 0.002 + 6.2 * 0.004 N m, below the 0.3 N m of the thesis."""
    path = ROOT / "docs/examples/force-by-threshold.nrs.yaml"
    document = document_of("mode-logic", path, cwd=tmp_path)
    assert document["switches"][0]["reach"]["torque"] == pytest.approx(0.2968)
    assert document["used_in_proof"] is False
    assert "switching is arbitrary" in run("mode-logic", path, cwd=tmp_path).stdout
