"""`nrs-design sweep`, as a user types it."""

import json
import signal
import subprocess
import sys
from dataclasses import replace
from fractions import Fraction
from time import sleep

import pytest

from nrs_design.certificates.certificate import content_id
from nrs_design.cli import exit_codes
from nrs_design.cli.sweep import SWEPT
from nrs_design.pipeline.sweep_answers import add_answer, read_answers
from tests.support import SOFT_TISSUE, document_of, run

STIFFNESS = "environments.soft.stiffness"
# Proved, refuted.
TWO = f"{STIFFNESS}=700,2000 N/m"


@pytest.fixture
def spec(tmp_path):
    path = tmp_path / "mine.nrs.yaml"
    path.write_text(SOFT_TISSUE.read_text(encoding="utf-8"), encoding="utf-8")
    return path.name


KEPT = ("--resume", "kept.jsonl")


def kept(folder):
    return read_answers(folder / "kept.jsonl")


def test_what_a_point_says_is_what_the_command_says(tmp_path, spec):
    swept = document_of("sweep", spec, "--set", TWO, "certify-switching", cwd=tmp_path, code=1)
    assert [point["values"] for point in swept["points"]] == [["700 N/m"], ["2000 N/m"]]
    text = (tmp_path / spec).read_text(encoding="utf-8")
    for point, value in zip(swept["points"], ("700", "2000"), strict=True):
        written = text.replace(
            "{nominal: 747.1461 N/m, range: [720.56 N/m, 768.17 N/m]}", f"{value} N/m"
        )
        assert written != text
        (tmp_path / "written.nrs.yaml").write_text(written, encoding="utf-8")
        alone = document_of("certify-switching", "written.nrs.yaml", cwd=tmp_path)
        for attempt in alone["attempts"]:
            del attempt["seconds"]
        result = point["result"]
        assert result == {key: alone[key] for key in result}


def test_a_run_goes_on_from_what_is_kept(tmp_path, spec):
    command = ("sweep", spec, *KEPT, "--set", TWO, "certify-switching", "--json")
    first = run(*command, cwd=tmp_path, code=1)
    assert "2 computed, 0 were there" in first.stderr
    second = run(*command, cwd=tmp_path, code=1)
    assert "0 computed, 2 were there" in second.stderr
    assert second.stdout == first.stdout
    # Another command, or another spec, is another question.
    run("sweep", spec, *KEPT, "--set", TWO, "check", cwd=tmp_path, code=0)
    assert "2 computed" in run(*command, cwd=tmp_path, code=1).stderr
    changed = (tmp_path / spec).read_text(encoding="utf-8").replace("torque: 0.3", "torque: 0.4")
    (tmp_path / spec).write_text(changed, encoding="utf-8")
    assert "2 computed" in run(*command, cwd=tmp_path, code=1).stderr


def interrupted(tmp_path, command, how):
    process = subprocess.Popen(
        [sys.executable, "-m", "nrs_design", *command],
        cwd=tmp_path,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    file = tmp_path / "kept.jsonl"
    while not (file.exists() and file.read_bytes().count(b"\n") > 3) and process.poll() is None:
        sleep(0.001)
    process.send_signal(how)
    return process.wait()


@pytest.mark.parametrize("jobs", [1, 2])
@pytest.mark.parametrize(
    ("how", "code"), [(signal.SIGKILL, -signal.SIGKILL), (signal.SIGINT, exit_codes.INTERRUPTED)]
)
def test_a_run_that_is_killed_goes_on(tmp_path, spec, how, code, jobs):
    """It loses what it was at, and nothing else."""
    command = ("sweep", spec, *KEPT, "--set", f"{STIFFNESS}=700..740/200 N/m", "check", "--json")
    assert interrupted(tmp_path, (*command, "--jobs", str(jobs)), how) == code
    there = len(kept(tmp_path))
    assert 3 <= there < 200
    resumed = run(*command, cwd=tmp_path, code=0)
    assert f"{200 - there} computed, {there} were there" in resumed.stderr
    whole = run("sweep", spec, *command[4:], cwd=tmp_path, code=0)
    assert whole.stdout == resumed.stdout


def test_results_do_not_depend_on_how_many_processes_compute_them(tmp_path, spec):
    command = (
        "sweep", spec, "--set", f"{STIFFNESS}=700..2000/6 N/m", "certify-switching", "--json",
    )  # fmt: skip
    alone = run(*command, cwd=tmp_path, code=1)
    assert run(*command, "--jobs", 2, cwd=tmp_path, code=1).stdout == alone.stdout


def test_an_answer_that_was_cut_off_is_computed_again(tmp_path, spec):
    command = ("sweep", spec, *KEPT, "--set", TWO, "check", "--json")
    first = run(*command, cwd=tmp_path, code=0)
    file = tmp_path / "kept.jsonl"
    whole = file.read_bytes()
    file.write_bytes(whole[:-9])
    again = run(*command, cwd=tmp_path, code=0)
    assert "1 computed, 1 were there" in again.stderr
    assert again.stdout == first.stdout
    assert "2 were there" in run(*command, cwd=tmp_path, code=0).stderr


def faster(document):
    rate = Fraction(document["statements"][0]["rate"])
    document["statements"][0]["rate"] = str(2 * rate)
    return document


def indefinite(document):
    node = document["statements"][0]["nodes"][0]
    node["form"] = [[-entry for entry in row] for row in node["form"]]
    return document


def of_another_spec(document):
    document["spec"]["sha256"] = "0" * 64
    return document


def forged(certificate, change):
    """As whoever forges one would: with the id of what it says now."""
    document = change(json.loads(certificate))
    return json.dumps(document | {"id": content_id(document)})


def test_proved_is_used_again_only_with_a_certificate_that_holds(tmp_path, spec):
    """The rule that matters: no file in a folder makes something proved."""
    command = ("sweep", spec, *KEPT, "--set", f"{STIFFNESS}=700 N/m", "certify-switching", "--json")
    first = run(*command, cwd=tmp_path, code=0)
    (whole,) = kept(tmp_path).values()
    result, certificate = dict(whole.result), whole.certificate
    fast = json.loads(forged(certificate, faster))["statements"][0]["rate"]
    for change in (
        {"certificate": ""},
        {"certificate": "{"},
        {
            "certificate": forged(certificate, faster),
            "result": result | {"decay_rate": float(Fraction(fast)), "decay_rate_exact": fast},
        },
        {"certificate": forged(certificate, indefinite)},
        {"certificate": forged(certificate, of_another_spec)},
        {"code": 1},
        {"code": 77},
        {"result": {}, "certificate": ""},
        {"result": result | {"decay_rate": 2 * result["decay_rate"]}},
        {"result": result | {"margin": {"proved_scale": 2.0}}},
        {"result": {k: v for k, v in result.items() if k != "verdict"}},
    ):
        add_answer(tmp_path / "kept.jsonl", replace(whole, **change))
        done = run(*command, cwd=tmp_path, code=0)
        assert "1 computed, 0 were there" in done.stderr
        assert done.stdout == first.stdout
    assert "0 computed, 1 were there" in run(*command, cwd=tmp_path, code=0).stderr


def test_every_command_of_the_table_is_run(tmp_path):
    from nrs_design.cli.sweep_point import program_of

    for words in map(str.split, SWEPT):
        found = program_of(words[0])
        for word in words:
            found = found.commands[word]
        names = [parameter.name for parameter in found.params]
        assert {"spec", "specs"} & set(names)
        assert "as_json" in names
