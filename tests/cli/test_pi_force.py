"""A PI force controller, from the spec to the program of a processor, as a user types it."""

import pytest

from tests.support import ROOT, document_of, run

SPECS = ROOT / "specs/neuroboscope"
RUNS = ROOT / "docs/examples/force-limit-runs.nrs.yaml"


def test_what_the_thesis_holds_to_be_impossible_is_proved(tmp_path):
    spec = SPECS / "force-limit-pi.nrs.yaml"
    result = run("certify-switching", spec, "-v", "--out", "ours.cert.json", cwd=tmp_path, code=0)
    assert "PROVED" in result.stdout
    assert "decays at 20 1/s, and stays in the command" in result.stdout
    run("verify", "ours.cert.json", spec, cwd=tmp_path, code=0)


def test_its_gains_are_tuned_and_shown(tmp_path):
    (item, other) = document_of("tune", RUNS, cwd=tmp_path)["force"]
    assert (item["name"], item["Ki"]) == ("proportional", 0)
    assert (other["name"], other["Ki"]) == ("integral", pytest.approx(0.526))
    assert other["steady_state_ratio"] == 0
    shown = run("tune", RUNS, cwd=tmp_path).stdout
    assert "Ki = 0.526 rad/(N m s)" in " ".join(shown.split())


def test_a_settling_time_that_is_too_short_is_refused_at_its_place(tmp_path):
    path = tmp_path / "fast.nrs.yaml"
    path.write_text(RUNS.read_text().replace("settling_time: 0.3 s", "settling_time: 0.1 s"))
    result = run("tune", path, cwd=tmp_path, code=2)
    assert "another pole is slower" in result.stderr
    assert "settling_time: 0.1 s" in result.stderr


def test_runs_with_p_and_pi(tmp_path):
    """Thesis 6.3.3.3 measured 2 and 12 %; X_i is the reference at the switch."""
    found = {
        one["scenario"]: one["metrics"]["force_control"][0]["steady_state_error"]
        for one in document_of("simulate", RUNS, "--no-bound", cwd=tmp_path, code=0)["runs"]
    }
    assert abs(found["with-p"] - 0.1184) < 1e-4
    assert found["with-pi"] < 1e-8


def test_the_program_of_the_proved_law(tmp_path):
    spec = SPECS / "force-limit-pi-sampled.nrs.yaml"
    certificate = ROOT / "reports/force-limit-pi-sampled.cert.json"
    arguments = ("--certificate", certificate, "--format", "c", "--out", tmp_path)
    run("export", spec, *arguments, "--sample-time", "2 ms", cwd=tmp_path, code=0)
    source = (tmp_path / "force-limit-pi-sampled.c").read_text()
    assert "state->integral = next_integral;" in source
