"""`nrs-design simulate --worst-case` and `--monte-carlo`, as a user types them."""

import os
import signal
import subprocess
import sys
import time

import pytest

from tests.simulation.interactions import text_of
from tests.support import document_of, run

LAW = {"insertion": "{type: impedance, environment: soft, Mt: 0 kg*m^2, Bt: 2.15 N*m*s/rad}"}
SOFT = {
    "soft": "{model: elastic, stiffness: {nominal: 43 N*m/rad, range: [40 N*m/rad, 46 N*m/rad]}}"
}
RUN = "command: {constant: 8 deg/s}, duration: 0.2 s, surfaces: [{environment: soft, at: 0.1 deg}]"


@pytest.fixture
def spec(tmp_path):
    path = tmp_path / "small.nrs.yaml"
    more = "contact: losable\ndisturbances: {command: 8 deg/s}\n"
    path.write_text(text_of(LAW, SOFT, scenario=RUN, more=more))
    return path


@pytest.mark.slow
def test_the_worst_case_beside_limits_and_bounds(spec, tmp_path):
    document = document_of("simulate", spec, "--worst-case", "--out", "runs", cwd=tmp_path, code=0)
    assert document["schema"] == "nrs-design/simulate/1"
    found = {item["output"]: item for item in document["worst_case"]["found"]}
    assert found.keys() == {"force", "velocity", "deflection"}
    for item in found.values():
        assert 0 < item["worst_found"] < item["certified_bound"]
        assert item["bound_over_found"] > 1
        assert item["worst_found"] >= max(item["starts"]) * 0.99
    assert found["force"]["exceeds_limit"] == (found["force"]["worst_found"] > 0.3)
    names = {f"small.worst-{name}.{s}" for name in found for s in ("csv", "npz", "svg", "png")}
    assert {path.name for path in (tmp_path / "runs").iterdir()} == names
    told = run("simulate", spec, "--worst-case", "--no-bound", cwd=tmp_path).stdout
    assert "worst found" in told
    assert "No bound is certified" in told


@pytest.mark.slow
def test_shares_are_printed_with_their_intervals(spec, tmp_path):
    study = document_of(
        "simulate", spec, "--monte-carlo", "8", "--no-bound", "--out", ".", cwd=tmp_path, code=0
    )["monte_carlo"]
    assert (study["runs"], study["seed"], study["stopped"]) == (8, 0, 0)
    share = study["above_limit"]["torque"]
    assert share["low"] <= share["share"] <= share["high"]
    rows = (tmp_path / "small.monte-carlo.csv").read_text().splitlines()
    assert rows[0].startswith("run,scenario,seed,peak_torque_Nm,")
    assert len(rows) == 9


@pytest.mark.slow
def test_an_interrupted_study_goes_on_as_if_nothing_had_been(spec, tmp_path):
    command = [sys.executable, "-m", "nrs_design", "simulate", str(spec), "--no-bound"]
    command += ["--monte-carlo", "200", "--jobs", "2", "--resume", "runs.jsonl"]
    # A child of a shell in the background would be deaf to the signal.
    process = subprocess.Popen(
        command,
        cwd=tmp_path,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )
    file = tmp_path / "runs.jsonl"
    for _ in range(600):
        if file.exists() and file.read_bytes().count(b"\n") > 6:
            break
        time.sleep(0.1)
    os.killpg(process.pid, signal.SIGINT)
    _, said = process.communicate(timeout=60)
    assert process.returncode == 130, said
    assert "goes on from there" in said
    kept = file.read_bytes().count(b"\n") - 1
    assert 6 <= kept < 200
    again = run(*command[3:], cwd=tmp_path, code=0)
    assert again.stdout == run(*command[3:-1], "other.jsonl", cwd=tmp_path, code=0).stdout
    assert file.read_bytes() == (tmp_path / "other.jsonl").read_bytes()


def test_runs_are_kept_behind_no_link(spec, tmp_path):
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "led").symlink_to("elsewhere")
    command = ("simulate", spec, "--monte-carlo", "2", "--no-bound", "--resume")
    result = run(*command, "led/runs.jsonl", cwd=tmp_path, code=2)
    assert "lies behind the symbolic link led" in result.stderr
    assert not list((tmp_path / "elsewhere").iterdir())


def test_options_that_nothing_would_heed_are_refused(spec, tmp_path):
    result = run("simulate", spec, "--worst-case", "--scenario", "run", cwd=tmp_path, code=2)
    assert not result.stdout
    assert "not within a scenario" in result.stderr


def test_what_no_adversary_plays_against_is_said(tmp_path):
    path = tmp_path / "small.nrs.yaml"
    path.write_text(text_of({"position": "{type: position}"}, SOFT))
    result = run("simulate", path, "--worst-case", cwd=tmp_path, code=2)
    assert "position is given a position" in result.stderr
    assert "--monte-carlo" in result.stderr


def test_other_commands_in_a_file_of_the_spec_are_another_study(tmp_path):
    path = tmp_path / "study.nrs.yaml"
    path.write_text(text_of(LAW, SOFT, scenario="command: {csv: hand.csv}, duration: 0.2 s"))
    command = ("simulate", path, "--monte-carlo", "2", "--resume", "runs.jsonl", "--no-bound")
    for speed, code in ((4, 0), (5, 2), (4, 0)):
        (tmp_path / "hand.csv").write_text(f"time_s,velocity_deg_s\n0,0\n0.1,{speed}\n0.2,0\n")
        run(*command, cwd=tmp_path, code=code)
    assert (tmp_path / "runs.jsonl").read_bytes().count(b"\n") == 3
    other = run(*command, "--engine", "sampled", cwd=tmp_path, code=2)
    assert "was begun with no --engine, not --engine sampled" in other.stderr
