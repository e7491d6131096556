import json
import re
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

from nrs_design.cli import main
from tests.design.holder import USELESS
from tests.gating.conftest import STABLE
from tests.support import PRINT_ERROR, ROOT, typed
from tests.terminal import run_on_terminal

BROKEN = STABLE.replace("A: [[-1, 1], [-1, -1]]", "A: [[-1, 1]]")


@pytest.fixture
def gate(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    Path("specs").mkdir()
    Path("specs/stable.nrs.yaml").write_text(STABLE)

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["nrs-design", "gate", *map(str, arguments)])
        with pytest.raises(SystemExit) as caught:
            main()
        return int(caught.value.code or 0)

    return run


@pytest.mark.slow
def test_shipped_specs_pass_locked_and_unlocked(gate, capsys):
    assert gate(ROOT / "specs", "--no-reports") == 0
    assert "all fulfilled" in capsys.readouterr().out
    assert gate(ROOT / "specs", "--locked") == 0


def test_as_typed(gate, tmp_path):
    done = typed("gate", "specs", "--no-reports", "-v", cwd=tmp_path, code=0)
    assert "specs/stable.nrs.yaml" in done.stdout
    assert "nrs.lock written" in done.stderr
    assert "1 s" not in done.stdout.replace("1 spec", ""), "times belong on stderr"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["nrs.lock", "reports", "specs"]
    assert [p.name for p in (tmp_path / "reports").iterdir()] == ["stable.cert.json"]


def test_quiet_says_only_what_is_not_fulfilled(gate, capsys):
    assert gate("specs", "--no-reports", "-q") == 0
    assert capsys.readouterr() == ("", "")
    assert gate(PRINT_ERROR, "--no-reports", "-q") == 1
    out, err = capsys.readouterr()
    assert err == ""
    assert {line.split(": ")[1] for line in out.splitlines()} == {
        "NRS101 refuted",
        "NRS102 refuted",
    }
    assert gate("specs", "--locked", "-q", "--json") == 0
    assert json.loads(capsys.readouterr().out)["passed"]


def test_the_worst_fact_leads_although_all_is_fulfilled(gate, capsys):
    Path("specs/holder.nrs.yaml").write_text(USELESS)
    assert gate("specs", "--no-reports") == 0
    said = " ".join(capsys.readouterr().err.split())
    worst = "warning: specs/holder.nrs.yaml:5:30: simulated, insertion-and-withdrawal: a torque of "
    assert said.startswith(f"{worst}0.9968 N*m, beyond limits.torque of 0.5 N*m")
    assert "note: 6 more remarks on designs" in said
    assert gate("specs", "--locked") == 0
    again = " ".join(capsys.readouterr().err.split())
    assert again.startswith(f"{worst}0.9968 N*m, beyond limits.torque of 0.5 N*m (as locked; not")
    assert "proved for contact that is kept" in again


def test_a_narrow_terminal(tmp_path):
    shown, code = run_on_terminal(50, "gate", PRINT_ERROR, "--no-reports", "-v", cwd=tmp_path)
    assert code == 1
    assert "\x1b[1;31mrefuted\x1b[0m:" in shown
    plain = re.sub("\x1b\\[[0-9;?]*[A-Za-z]", "", shown).splitlines()
    assert any(line.split() == ["verdict", "refuted"] for line in plain)
    assert max(len(line) for line in plain if "/" not in line) <= 50


def test_the_number_of_further_faults_of_a_spec(gate, capsys):
    Path("specs/broken.nrs.yaml").write_text(BROKEN.replace("switching", "swiching"))
    assert gate("specs", "--no-reports") == 2
    assert "; 1 more fault in this file" in capsys.readouterr().out


def test_usage(gate):
    assert gate() == 2
    assert gate("specs", "--format", "xml") == 2
    assert gate("specs", "--json", "--format", "sarif") == 2


@pytest.mark.parametrize(
    ("format_", "failures"),
    [
        ("github", lambda out: out.count("::error ")),
        ("sarif", lambda out: len(json.loads(out)["runs"][0]["results"])),
        ("junit", lambda out: int(ET.fromstring(out).get("failures"))),
        ("json", lambda out: out.count('"status": "refuted"')),
    ],
)
def test_documents_go_to_stdout_and_the_sum_to_stderr(gate, capsys, format_, failures):
    # What is written into the lock is noted once.
    gate(PRINT_ERROR, "specs", "--no-reports", "--quiet")
    capsys.readouterr()
    texts = []
    for _ in range(2):
        assert gate(PRINT_ERROR, "--no-reports", "--format", format_) == 1
        texts.append(capsys.readouterr().out)
    assert texts[0] == texts[1]
    assert failures(texts[0]) == 3
    assert gate("specs", "--no-reports", "--format", format_) == 0
    out, err = capsys.readouterr()
    assert "1 spec: 1 proved; 4 obligations, all fulfilled\n" in err
    assert "all fulfilled" not in out
    assert out == "" or out.endswith("\n")
    assert gate("specs", "--no-reports", "--format", format_, "--out", "ci/gate.out", "-q") == 0
    assert capsys.readouterr() == ("", "")
    assert Path("ci/gate.out").read_text() == out


def test_a_document_replaces_documents_only(gate, capsys):
    assert gate("specs", "--no-reports") == 0
    before = Path("nrs.lock").read_bytes()
    Path("record.csv").write_text("time,force")
    refused = {"nrs.lock": "not overwritten", "record.csv": "not overwritten"}
    for foreign, why in (refused | {"specs/stable.nrs.yaml": "the name of a spec"}).items():
        assert gate("specs", "--no-reports", "--format", "json", "--out", foreign) == 2
        assert why in capsys.readouterr().err
    assert Path("nrs.lock").read_bytes() == before
    assert Path("record.csv").read_text() == "time,force"
    for format_ in ("text", "json", "sarif", "junit", "github", "text"):
        assert gate("specs", "--no-reports", "--format", format_, "--out", "gate.out", "-q") == 0


def test_a_lock_that_cannot_be_written_is_said_before_the_proofs(gate, capsys):
    Path("nrs.lock").mkdir()
    assert gate("specs", "--no-reports") == 2
    assert "error[NRS005]: nrs.lock" in capsys.readouterr().err
    assert not Path("reports").exists()


def test_reports_are_written_by_default(gate):
    assert gate("specs") == 0
    assert "<html" in Path("reports/stable.html").read_text()


def test_pruning(gate, capsys):
    assert gate("specs", "--no-reports") == 0
    Path("specs/stable.nrs.yaml").unlink()
    Path("specs/other.nrs.yaml").write_text(STABLE.replace("name: stable", "name: other"))
    assert gate("specs", "--no-reports") == 0
    assert "--prune" in capsys.readouterr().err
    assert gate("specs", "--locked") == 1
    assert gate("specs", "--no-reports", "--prune") == 0
    assert gate("specs", "--locked") == 0
    assert gate("specs", "--locked", "--prune") == 2
