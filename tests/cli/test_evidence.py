"""``nrs-design evidence`` as typed."""

import hashlib
import json
import subprocess

import pytest

from nrs_design.spec import read_spec
from tests.support import (
    COMMUTING,
    ROBOT,
    ROOT,
    SOFT_TISSUE,
    document_of,
    program_named,
    run,
    typed,
)

PROOF = ("--certificate", ROOT / "reports/commuting.cert.json")
UNSTABLE = """kind: switched-system
name: unstable
time: continuous
modes:
  - {name: a, A: [[1]]}
switching: arbitrary
"""


def facts_in(folder):
    return json.loads((folder / "evidence.json").read_text())


def contents(folder):
    return {p.relative_to(folder): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def results_file(folder, spec_sha256, **items):
    path = folder / "results.yaml"
    lines = [f"  {id.replace('__', '.')}: {item}" for id, item in items.items()]
    path.write_text("\n".join([f'spec: "{spec_sha256}"', "results:", *lines, ""]))
    return path


def test_it_certifies_writes_and_checks(tmp_path):
    done = typed("evidence", COMMUTING, "--out", "out", cwd=tmp_path, code=0)
    assert done.stdout.startswith("commuting: PROVED, evidence in out (14 files)\n")
    done = run("evidence", "--check", "out", cwd=tmp_path, code=0)
    assert done.stdout.startswith("commuting: out holds: 14 files")
    sums = subprocess.run(
        [program_named("sha256sum"), "--check", "--quiet", "SHA256SUMS"], cwd=tmp_path / "out"
    )
    assert sums.returncode == 0


def test_the_same_spec_gives_the_same_bytes(tmp_path):
    for folder in ("a", "b", "b"):
        run("evidence", COMMUTING, *PROOF, "--out", folder, cwd=tmp_path, code=0)
    assert contents(tmp_path / "a") == contents(tmp_path / "b")
    assert facts_in(tmp_path / "a")["date"] is None


def test_a_date_is_written_where_it_is_asked_for(tmp_path):
    run("evidence", COMMUTING, *PROOF, "--out", "a", "--date", "2026-01-31", cwd=tmp_path, code=0)
    assert facts_in(tmp_path / "a")["date"] == "2026-01-31"
    assert "Date: 2026-01-31" in (tmp_path / "a/README.md").read_text()
    run("evidence", "--check", "a", cwd=tmp_path, code=0)


def test_results_settle_assumptions_of_this_spec_only(tmp_path):
    run("evidence", COMMUTING, *PROOF, "--out", "a", cwd=tmp_path, code=0)
    facts = facts_in(tmp_path / "a")
    assert facts["open"] == ["matrices.given", "at-a-switch.any-signal", "tool.independent-check"]
    sha256 = facts["spec"]["sha256"]
    passed = "{result: passed, date: 2026-01-31, reference: 'report | 17'}"
    items = {"matrices__given": passed, "tool__independent-check": passed}
    given = ("--results", results_file(tmp_path, sha256, **items))
    run("evidence", COMMUTING, *PROOF, *given, "--out", "a", cwd=tmp_path, code=0)
    assert facts_in(tmp_path / "a")["open"] == ["at-a-switch.any-signal"]
    page = (tmp_path / "a/assumptions.md").read_text()
    assert r"| the user's test | passed |" in page
    assert r"passed, 2026-01-31, report \| 17" in page
    run("evidence", "--check", "a", cwd=tmp_path, code=0)
    given = ("--results", results_file(tmp_path, "0" * 64, **items))
    done = run("evidence", COMMUTING, *PROOF, *given, "--out", "a", cwd=tmp_path, code=0)
    assert "found with another spec" in done.stderr
    assert facts_in(tmp_path / "a")["open"] == facts["open"]
    assert "Results are of another spec" in (tmp_path / "a/README.md").read_text()


def test_a_goal_that_is_not_proved_is_in_the_folder_and_in_the_exit_code(tmp_path):
    spec = tmp_path / "fast.nrs.yaml"
    text = SOFT_TISSUE.read_text()
    spec.write_text(text.replace("switching:", "goals: {decay_rate: 90 1/s}\nswitching:"))
    done = run("evidence", spec, "--out", "a", cwd=tmp_path, code=3)
    assert "inconclusive: system: decay_rate: the proved decay rate is" in done.stdout
    hazard = next(h for h in facts_in(tmp_path / "a")["hazards"] if h["id"] == "unstable-switching")
    assert hazard["missed"] == ["NRS108 system: decay_rate"]
    page = (tmp_path / "a/README.md").read_text()
    assert "**inconclusive**: system: decay_rate" in page
    assert "1 missed" in (tmp_path / "a/argument.txt").read_text()


def test_every_claim_of_a_certificate_is_told(tmp_path):
    proof = ROOT / "reports/oscillator-range.cert.json"
    spec = ROOT / "specs/examples/oscillator-range.nrs.yaml"
    run("evidence", spec, "--certificate", proof, "--out", "a", cwd=tmp_path, code=0)
    claims = [statement["claim"] for statement in json.loads(proof.read_text())["statements"]]
    facts, page = facts_in(tmp_path / "a"), (tmp_path / "a/README.md").read_text()
    assert sorted([facts["claim"], *facts["also"]]) == sorted(claims)
    assert len(claims) == 2
    assert all(claim in page for claim in claims)
    assert "README.md has 1 claim more" in (tmp_path / "a/argument.txt").read_text()


@pytest.mark.parametrize("of_this_spec", [True, False])
def test_a_failed_test_is_loud(tmp_path, of_this_spec):
    sha256 = read_spec(COMMUTING).sha256
    failed = "{result: failed, date: 2026-01-31, reference: x}"
    results = results_file(tmp_path, sha256 if of_this_spec else "0" * 64, matrices__given=failed)
    given = (*PROOF, "--results", results)
    done = run("evidence", COMMUTING, *given, "--out", "a", cwd=tmp_path, code=1)
    assert "failed: matrices.given: failed, 2026-01-31, x" in done.stdout
    assert facts_in(tmp_path / "a")["failed"] == ["matrices.given"]
    assert "[REFUTED]" in (tmp_path / "a/argument.txt").read_text()
    assert 'class="refuted"' in (tmp_path / "a/argument.svg").read_text()


def test_an_unknown_id_writes_nothing(tmp_path):
    results = results_file(tmp_path, "0" * 64, tissue__linear="{result: passed}")
    given = (*PROOF, "--results", results)
    done = run("evidence", COMMUTING, *given, "--out", "a", cwd=tmp_path, code=2)
    assert "there is no id 'tissue.linear'" in done.stderr
    assert "matrices.given, at-a-switch.any-signal, tool.independent-check" in done.stderr
    assert not (tmp_path / "a").exists()


def test_what_is_left_can_be_filled_in(tmp_path):
    run("evidence", COMMUTING, *PROOF, "--out", "a", cwd=tmp_path, code=0)
    form = (tmp_path / "a/results-to-do.yaml").read_text()
    filled = form.replace('result: ""', "result: passed").replace('date: ""', "date: 2026-01-31")
    (tmp_path / "filled.yaml").write_text(filled.replace('reference: ""', "reference: x"))
    given = (*PROOF, "--results", "filled.yaml")
    run("evidence", COMMUTING, *given, "--out", "a", cwd=tmp_path, code=0)
    assert facts_in(tmp_path / "a")["open"] == []
    assert "0 results to find" in (tmp_path / "a/results-to-do.yaml").read_text()


def test_a_binary_is_told_by_its_hash(tmp_path):
    (tmp_path / "firmware.bin").write_bytes(b"\x7fELF")
    (tmp_path / "other.bin").write_bytes(b"")
    named = ("--binary", "firmware.bin")
    run("evidence", COMMUTING, *PROOF, *named, "--out", "a", cwd=tmp_path, code=0)
    sha256 = hashlib.sha256(b"\x7fELF").hexdigest()
    assert facts_in(tmp_path / "a")["binaries"] == [
        {"name": "firmware.bin", "size": 4, "sha256": sha256}
    ]
    assert sha256 in (tmp_path / "a/hazards.md").read_text()
    run("evidence", "--check", "a", *named, cwd=tmp_path, code=0)
    done = run("evidence", "--check", "a", "--binary", "other.bin", cwd=tmp_path, code=1)
    assert "other.bin is none of the binaries" in done.stdout


def test_what_is_not_proved_has_no_evidence(tmp_path):
    (tmp_path / "unstable.nrs.yaml").write_text(UNSTABLE)
    done = run("evidence", "unstable.nrs.yaml", "--out", "a", cwd=tmp_path, code=1)
    assert "no evidence written: the design is not proved: refuted" in done.stderr
    assert not (tmp_path / "a").exists()
    found = document_of("evidence", "unstable.nrs.yaml", "--out", "a", cwd=tmp_path, code=1)
    assert (found["verdict"], found["folder"]) == ("refuted", None)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ([COMMUTING], "name one of --out and --check"),
        ([COMMUTING, "--out", "a", "--check", "a"], "name one of --out and --check"),
        (["--out", "a"], "no spec is named"),
        (["--check", "a", "--date", "2026-01-31"], "are for writing"),
        (["--check", "none"], "there is no such folder"),
        ([COMMUTING, "--out", "a", "--date", "31.1.2026"], "'31.1.2026' is no date"),
        ([COMMUTING, "--out", "a", "--binary", "none.bin"], "none.bin: cannot be read"),
        (
            [ROOT / "specs/robots/neuroboscope.nrs.yaml", "--out", "a"],
            "a robot spec has no controllers",
        ),
    ],
)
def test_wrong_usage_is_one_message_and_writes_nothing(tmp_path, arguments, said):
    done = run("evidence", *arguments, cwd=tmp_path, code=2)
    assert said in done.stderr
    assert not (tmp_path / "a").exists()


def test_json(tmp_path):
    arguments = ("evidence", COMMUTING, *PROOF, "--out", "a")
    found = document_of(*arguments, cwd=tmp_path, code=0)
    assert found["schema"] == "nrs-design/evidence/1"
    assert sorted(found["files"]) == sorted(p.as_posix() for p in contents(tmp_path / "a"))
    found = document_of("evidence", "--check", "a", cwd=tmp_path, code=0)
    assert (found["check"], found["faults"], found["spec"]) == ("holds", [], "commuting")
    (tmp_path / "a/README.md").write_text("x")
    found = document_of("evidence", "--check", "a", cwd=tmp_path, code=1)
    assert (found["check"], found["faults"]) == ("rejected", ["'README.md' was changed"])


def test_a_spec_with_a_robot_takes_it_along(tmp_path):
    spec = ROBOT / "soft-tissue-axes.nrs.yaml"
    proof = ("--certificate", ROOT / "reports/soft-tissue-axes.cert.json")
    run("evidence", spec, *proof, "--out", "a", cwd=tmp_path, code=0)
    assert sorted(p.name for p in (tmp_path / "a/spec/robots").iterdir()) == [
        "neuroboscope.bounds.json",
        "neuroboscope.nrs.yaml",
    ]
    run("evidence", "--check", "a", cwd=tmp_path, code=0)
