import json
import re
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

from nrs_design.cli import main
from tests.gating.conftest import STABLE
from tests.support import PRINT_ERROR, typed
from tests.terminal import run_on_terminal


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


def test_as_typed(gate, tmp_path):
    done = typed("gate", "specs", "--no-reports", "-v", cwd=tmp_path, code=0)
    assert "specs/stable.nrs.yaml" in done.stdout
    assert "nrs.lock written" in done.stderr
    assert "1 s" not in done.stdout.replace("1 spec", ""), "times belong on stderr"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["nrs.lock", "reports", "specs"]
    assert [p.name for p in (tmp_path / "reports").iterdir()] == ["stable.cert.json"]


def test_a_narrow_terminal(tmp_path):
    shown, code = run_on_terminal(50, "gate", PRINT_ERROR, "--no-reports", "-v", cwd=tmp_path)
    assert code == 1
    assert "\x1b[1;31mrefuted\x1b[0m:" in shown
    plain = re.sub("\x1b\\[[0-9;?]*[A-Za-z]", "", shown).splitlines()
    assert any(line.split() == ["verdict", "refuted"] for line in plain)
    assert max(len(line) for line in plain if "/" not in line) <= 50


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
