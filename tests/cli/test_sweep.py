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
from nrs_design.cli.sweep_point import Job, answer_point
from nrs_design.sweeps.grid import read_grid
from nrs_design.sweeps.store import Store
from tests.support import SOFT_TISSUE, document_of, run

STIFFNESS = "environments.soft.stiffness"
# Proved, refuted.
TWO = f"{STIFFNESS}=700,2000 N/m"


@pytest.fixture
def spec(tmp_path):
    path = tmp_path / "mine.nrs.yaml"
    path.write_text(SOFT_TISSUE.read_text(encoding="utf-8"), encoding="utf-8")
    return path.name


def kept(folder):
    return sorted(folder.rglob("*.json"))


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
    command = ("sweep", spec, "--set", TWO, "certify-switching", "--json")
    first = run(*command, cwd=tmp_path, code=1)
    assert "2 computed, 0 were there" in first.stderr
    # An answer and a certificate each.
    assert len(kept(tmp_path / "mine.sweep")) == 4
    second = run(*command, cwd=tmp_path, code=1)
    assert "0 computed, 2 were there" in second.stderr
    assert second.stdout == first.stdout


def interrupted(tmp_path, command, how):
    process = subprocess.Popen(
        [sys.executable, "-m", "nrs_design", *command],
        cwd=tmp_path,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    while len(kept(tmp_path / "mine.sweep")) < 3 and process.poll() is None:
        sleep(0.001)
    process.send_signal(how)
    return process.wait()


@pytest.mark.parametrize(
    ("how", "code"), [(signal.SIGKILL, -signal.SIGKILL), (signal.SIGINT, exit_codes.INTERRUPTED)]
)
def test_a_run_that_is_killed_goes_on(tmp_path, spec, how, code):
    """It loses what it was at, and nothing else; no half-written file is left."""
    command = ("sweep", spec, "--set", f"{STIFFNESS}=700..740/40 N/m", "check", "--json")
    assert interrupted(tmp_path, command, how) == code
    there = {path: path.read_bytes() for path in kept(tmp_path / "mine.sweep")}
    assert 3 <= len(there) < 40
    resumed = run(*command, cwd=tmp_path, code=0)
    assert f"{40 - len(there)} computed, {len(there)} were there" in resumed.stderr
    assert all(path.read_bytes() == content for path, content in there.items())
    whole = run(*command, "--store", "new", cwd=tmp_path, code=0)
    assert whole.stdout == resumed.stdout


def test_results_do_not_depend_on_how_many_processes_compute_them(tmp_path, spec):
    command = (
        "sweep", spec, "--set", f"{STIFFNESS}=700..2000/6 N/m", "certify-switching", "--json",
    )  # fmt: skip
    alone = run(*command, "--store", "one", cwd=tmp_path, code=1)
    two = run(*command, "--store", "two", "--jobs", 2, cwd=tmp_path, code=1)
    assert two.stdout == alone.stdout
    one, other = ({p.name: p.read_bytes() for p in kept(tmp_path / n)} for n in ("one", "two"))
    assert one == other


def certified(tmp_path, spec, value="700"):
    command = ("sweep", spec, "--set", f"{STIFFNESS}={value} N/m", "certify-switching", "--json")
    return run(*command, cwd=tmp_path)


def rewritten(entry, change):
    from nrs_design.sweeps.store import CachedAnswer

    document = json.loads(entry.read_text(encoding="utf-8"))
    forged = CachedAnswer(document["code"], change(document["result"]))
    entry.write_text(forged.text(document["key"]), encoding="utf-8")


def answer_and_certificate(tmp_path):
    certificate, answer = sorted(kept(tmp_path / "mine.sweep"), key=lambda path: len(path.name))[
        ::-1
    ]
    return answer, certificate


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


def agreeing(result, document):
    rate = float(Fraction(document["statements"][0]["rate"]))
    return result | {"decay_rate": rate}


def test_proved_is_used_again_only_with_a_certificate_that_holds(tmp_path, spec):
    """The rule that matters: no file in a folder makes something proved."""
    first = certified(tmp_path, spec)
    answer, certificate = answer_and_certificate(tmp_path)
    whole = certificate.read_text(encoding="utf-8")

    def is_computed_again():
        done = certified(tmp_path, spec)
        assert "1 computed, 0 were there" in done.stderr
        assert done.stdout == first.stdout
        assert certificate.read_text(encoding="utf-8") == whole

    certificate.unlink()
    is_computed_again()
    for forge in (faster, indefinite, of_another_spec):
        document = forge(json.loads(whole))
        # As whoever forges one would: with the id of what it says now, and an answer that agrees.
        certificate.write_text(json.dumps(document | {"id": content_id(document)}), "utf-8")
        rewritten(answer, lambda result, document=document: agreeing(result, document))
        is_computed_again()
    certificate.write_text("{", encoding="utf-8")
    is_computed_again()
    rewritten(answer, lambda result: result | {"decay_rate": 2 * result["decay_rate"]})
    is_computed_again()
    rewritten(answer, lambda result: result | {"margin": {"proved_scale": 2.0}})
    is_computed_again()
    rewritten(answer, lambda result: {k: v for k, v in result.items() if k != "verdict"})
    is_computed_again()
    assert "0 computed, 1 were there" in certified(tmp_path, spec).stderr


def test_an_answer_stays_until_it_is_replaced(tmp_path, spec, monkeypatch):
    """Another run in the same folder may be about to read it."""
    path, what = tmp_path / spec, ("optimize",)
    grid = read_grid(path, [f"{STIFFNESS}=700 N/m"])
    job = Job(path, grid, what, (), what, Store(tmp_path / "mine.sweep"))
    first = answer_point(job, 0)
    write, there = Store.write, []

    def watched(store, key, kept):
        there.append(store.read(key))
        write(store, key, kept)

    monkeypatch.setattr(Store, "write", watched)
    # What `optimize` proves is computed again in every run.
    assert answer_point(job, 0) == first
    assert [kept.id(first.key) for kept in there] == [first.id]


def test_every_command_of_the_table_is_run(tmp_path):
    from nrs_design.cli.sweep_point import program_of

    for words in map(str.split, SWEPT):
        found = program_of(words[0])
        for word in words:
            found = found.commands[word]
        names = [parameter.name for parameter in found.params]
        assert {"spec", "specs"} & set(names)
        assert "as_json" in names


def test_an_exit_code_is_that_of_what_is_shown(tmp_path, spec):
    asked = "--set", f"{STIFFNESS}=2000 N/m", "certify-switching"
    run("sweep", spec, *asked, cwd=tmp_path, code=1)
    (file,) = (path for path in kept(tmp_path / "mine.sweep") if "cert" not in path.name)
    store = Store(tmp_path / "mine.sweep")
    answer = store.read(file.stem)
    assert answer is not None
    store.write(file.stem, replace(answer, code=0))
    again = run("sweep", spec, *asked, cwd=tmp_path, code=1)
    assert "1 computed" in again.stderr
