"""`nrs-design mode-logic`, as a user types it, and what a proof makes of it."""

import json

import pytest

from tests.support import FORCE_LIMIT, ROOT, document_of, run

BY_SIGN = ROOT / "docs/examples/insertion-by-sign.nrs.yaml"
UNKNOWN = ROOT / "docs/examples/unknown-environment.nrs.yaml"


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
    found = document_of("mode-logic", UNKNOWN, cwd=tmp_path)
    assert found["type"] == "estimator"
    assert found["decision_at_most"] + found["right_at_least"] == pytest.approx(1)


def test_a_spec_without_logic(tmp_path):
    assert "has no mode_logic" in run("mode-logic", FORCE_LIMIT, cwd=tmp_path, code=2).stderr


@pytest.mark.slow
def test_a_wrong_controller_that_is_unstable_is_proved_for_as_long_as_it_lasts(tmp_path):
    """Under arbitrary switching it may last, and that is refuted."""
    result = run("certify-switching", UNKNOWN, "--out", "ours.cert.json", cwd=tmp_path, code=0)
    assert "in agile/tool" in result.stdout
    assert "by then the estimator has decided" in result.stdout
    assert "at rest nothing is decided" in result.stdout
    run("verify", "ours.cert.json", UNKNOWN, cwd=tmp_path, code=0)
    text = UNKNOWN.read_text().replace("switching: mode-logic", "switching: arbitrary")
    (tmp_path / "any.nrs.yaml").write_text(text)
    refuted = run(
        "certify-switching", "any.nrs.yaml", "--out", "any.cert.json", cwd=tmp_path, code=1
    )
    assert "agile/tool" in refuted.stdout


@pytest.mark.slow
def test_the_report_shows_it(tmp_path):
    run("report", BY_SIGN, "--out", "page.html", cwd=tmp_path, code=0)
    page = (tmp_path / "page.html").read_text()
    assert "Switches, in the order in which they are tried" in page
    assert "The dwell times are kept by the timer of the mode logic" in page


def test_rules_about_contacts_by_hand_with_ranges(tmp_path):
    """The corners of a range belong to its contact: the rules let them follow each other."""
    text = UNKNOWN.read_text().replace("104.7 N*m/rad", "50 N*m/rad")
    text = text.replace("43.0356 N*m/rad", "{nominal: 43 N*m/rad, range: [42 N*m/rad, 44 N*m/rad]}")
    logic = text[text.index("# The tool at") : text.index("design:")]
    rules = "switching: {transitions: [[agile/tissue, agile/tool], [agile/tool, careful/tool]]}"
    text = text.replace(logic, "").replace("switching: mode-logic", rules)
    (tmp_path / "given.nrs.yaml").write_text(text)
    result = run(
        "certify-switching", "given.nrs.yaml", "--out", "ours.cert.json", "--json", cwd=tmp_path
    )
    document = json.loads((tmp_path / "ours.cert.json").read_text())
    assert result.returncode == 0
    allowed = document["switching"]["transitions"]
    assert ["agile/tissue/k-min", "agile/tissue/k-max"] in allowed
    assert ["agile/tissue/k-max", "agile/tool"] in allowed
    assert ["careful/tool", "agile/tool"] not in allowed


def test_the_torque_stays_below_the_limit_when_force_control_takes_over(tmp_path):
    """0.27 + 0.002 + 6.2 * 0.004 N m, below the 0.3 N m of the thesis."""
    path = ROOT / "docs/examples/force-by-threshold.nrs.yaml"
    document = document_of("mode-logic", path, cwd=tmp_path)
    assert document["switches"][0]["reach"]["torque"] == pytest.approx(0.2968)
    assert document["used_in_proof"] is False
    assert "switching is arbitrary" in run("mode-logic", path, cwd=tmp_path).stdout


def test_a_run_says_that_no_estimator_is_in_it(tmp_path):
    (simulated,) = document_of("simulate", UNKNOWN, cwd=tmp_path, code=0)["runs"]
    assert any("the estimator of the mode logic" in line for line in simulated["not_modelled"])
