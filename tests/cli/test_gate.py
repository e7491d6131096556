import json
import re
import xml.etree.ElementTree as ET
from functools import partial
from pathlib import Path

import pytest

from tests.gating.conftest import STABLE
from tests.support import PRINT_ERROR, run
from tests.terminal import run_on_terminal


@pytest.fixture
def gate(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    Path("specs").mkdir()
    Path("specs/stable.nrs.yaml").write_text(STABLE)
    return partial(run, "gate", cwd=tmp_path)


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
def test_documents_go_to_stdout_and_the_sum_to_stderr(gate, format_, failures):
    # What is written into the lock is noted once.
    gate(PRINT_ERROR, "specs", "--no-reports", "--quiet")
    asked = ("--no-reports", "--format", format_)
    first, again = (gate(PRINT_ERROR, *asked, code=1).stdout for _ in range(2))
    assert first == again
    assert failures(first) == 3
    done = gate("specs", *asked, code=0)
    assert "1 spec: 1 proved; 4 obligations, all fulfilled\n" in done.stderr
    assert "all fulfilled" not in done.stdout
    assert done.stdout == "" or done.stdout.endswith("\n")
    silent = gate("specs", *asked, "--out", "ci/gate.out", "-q", code=0)
    assert (silent.stdout, silent.stderr) == ("", "")
    assert Path("ci/gate.out").read_text() == done.stdout
