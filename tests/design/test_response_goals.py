"""Goals for frequency responses, as a user types them: proved, refuted, not judged."""

import json
from fractions import Fraction

import pytest

from nrs_design.design.displayed_response import LargestResponse
from nrs_design.design.response_goals import JudgedResponse
from tests.support import ROOT, document_of, replaced, run

EXAMPLE = ROOT / "docs/examples/transparency.nrs.yaml"


def written(tmp_path, *changes):
    path = tmp_path / "felt.nrs.yaml"
    path.write_text(replaced(EXAMPLE.read_text("utf-8"), *changes), encoding="utf-8")
    return path


def obligations(folder, path):
    result = run("gate", path.name, "--no-reports", "--format", "json", cwd=folder)
    (spec,) = json.loads(result.stdout)["specs"]
    return [item for item in spec["obligations"] if item["rule"] == "NRS112"]


def test_the_gate_proves_the_example_and_locks_what_it_found(tmp_path):
    path = written(tmp_path)
    felt, off = obligations(tmp_path, path)
    assert (felt["status"], off["status"]) == ("proved", "proved")
    # At rest the hand feels the virtual damping, 2 N*m*s/rad.
    assert "is at most 2.00001 N*m*s/rad (rounded up)" in felt["message"]
    assert "at 0 rad/s" in felt["message"]
    line = path.read_text("utf-8").splitlines()[felt["line"] - 1]
    assert "transparency:" in line
    again = run("gate", "--locked", path.name, "--format", "json", cwd=tmp_path, code=0)
    (spec,) = json.loads(again.stdout)["specs"]
    kept = [item for item in spec["obligations"] if item["rule"] == "NRS112"]
    assert {item["status"] for item in kept} == {"met"}
    assert all("as locked" in item["message"] for item in kept)


def test_one_that_is_exceeded_is_refuted_with_its_place(tmp_path):
    path = written(tmp_path, ("2.3 N*m*s/rad", "1.99 N*m*s/rad"))
    felt, off = obligations(tmp_path, path)
    assert (felt["status"], off["status"]) == ("refuted", "proved")
    assert "at 0 rad/s" in felt["message"]


@pytest.mark.parametrize("change", [("0.7,", "0.50854,"), ("0.7,", "0.50853,")])
def test_optimize_shows_them_and_their_exit_code(tmp_path, change):
    """The largest error is between 0.508531 and 0.508532."""
    result = run("optimize", written(tmp_path, change), "--json", cwd=tmp_path)
    (item,) = json.loads(result.stdout)["controllers"]
    felt, off = item["responses"]
    proved = change[1] == "0.50854,"
    assert result.returncode == (0 if proved else 1)
    assert (felt["status"], felt["unit"]) == ("proved", "N*m*s/rad")
    assert off["status"] == ("proved" if proved else "refuted")
    assert off["at_least"] <= 0.5085316 < off["at_most"] * 1.005


def test_of_a_sampled_law_they_are_not_judged(tmp_path):
    path = written(tmp_path, ("switching:", "sampling: {period: 2 ms, delay: [0, 1]}\nswitching:"))
    (item,) = document_of("optimize", path, cwd=tmp_path, code=1)["controllers"]
    for found in item["responses"]:
        assert (found["status"], found["at_most"], found["at_least"]) == ("not judged", None, None)
        assert "the law is sampled" in found["shown"]


def test_the_report_has_them(tmp_path):
    text = run("report", written(tmp_path), cwd=tmp_path).stdout
    page = next(tmp_path.rglob("*.html")).read_text("utf-8")
    assert "Transparency and accuracy" in page, text
    assert "2.00001" in page


def test_on_an_axis_that_slides_the_unit_is_its_own(tmp_path):
    text = (ROOT / "docs/examples/insertion-axis.nrs.yaml").read_text("utf-8")
    path = tmp_path / "sliding.nrs.yaml"
    goal = "transparency: {max_impedance: 1000 N*s/m, band: [0 Hz, 1 Hz]}"
    text = text.replace("sampling: {period: 1 ms, delay: [0, 1]}\n", "")
    path.write_text(f"{text}\ngoals:\n  {goal}\n", encoding="utf-8")
    result = run("optimize", path, cwd=tmp_path)
    assert "transparency, at most 1000 N*s/m from 0 Hz to 1 Hz: PROVED" in result.stdout
    assert "N*m" not in result.stdout


def test_a_bound_that_is_not_shown_proves_and_refutes_nothing():
    def judged(found, why=""):
        return JudgedResponse("accuracy", "the error", Fraction(1, 2), "", "", found, why)

    half = Fraction(1, 2)
    for above, below, ends in (
        (half, Fraction(0), "proved"),
        (half + Fraction(1, 10**30), half, "undecided"),
        (None, half, "undecided"),
        (None, half + Fraction(1, 10**30), "refuted"),
    ):
        assert judged(LargestResponse(above, below, Fraction(1), {}, 1.0)).ends == ends
    assert judged(None, "no reason").ends == "not judged"
    assert judged(None, "no reason").said == "not judged: no reason"
    assert not judged(None).proved
    assert not judged(None).refuted
