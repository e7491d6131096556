"""Runs a command as a user does, and measures what it takes and what it touches."""

import hashlib
import json
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from tests.support import ROOT, SOON

MAX_MEBIBYTES = 300.0
# Far beyond what is allowed: only so that a hang ends.
PATIENCE = 120

PROGRAM = """
import json, re, sys, time
from nrs_design.cli import main
try:
    main()
finally:
    status = open("/proc/self/status").read()
    peak = int(re.search(r"VmHWM:\\s+(\\d+)", status)[1]) / 1024
    with open(sys.argv.pop(), "w") as file:
        json.dump({"seconds": time.process_time(), "mebibytes": peak}, file)
""".replace("    main()\n", "    measured = sys.argv.pop(1)\n    main()\n").replace(
    "sys.argv.pop(), ", "measured, "
)


@dataclass(frozen=True)
class Run:
    """What came of a command."""

    code: int
    text: str
    seconds: float
    mebibytes: float


def run(folder: Path, *arguments: str) -> Run:
    """Run a command in ``folder/work``; its needs are noted down in ``folder/scratch``."""
    scratch = folder / "scratch"
    scratch.mkdir(exist_ok=True)
    needs = scratch / "needs.json"
    result = subprocess.run(
        [sys.executable, "-c", PROGRAM, str(needs), *arguments],
        capture_output=True,
        cwd=folder / "work",
        check=False,
        stdin=subprocess.DEVNULL,
        timeout=PATIENCE,
        env=os.environ
        | {"PYTHONPATH": str(ROOT), "HOME": str(folder / "home"), "TMPDIR": str(scratch)}
        | {"MPLCONFIGDIR": str(scratch)},
    )
    measured = json.loads(needs.read_text())
    text = (result.stdout + result.stderr).decode("utf-8", "surrogateescape")
    return Run(result.returncode, text, measured["seconds"], measured["mebibytes"])


def tree(folder: Path) -> dict[str, str]:
    """Everything that a command in ``folder/work`` must not touch."""
    found = {}
    for path in sorted(folder.rglob("*")):
        if path.relative_to(folder).parts[0] not in ("work", "scratch"):
            content = path.read_bytes() if path.is_file() else b""
            found[str(path)] = hashlib.sha256(content).hexdigest()
    return found


def check(folder: Path, *arguments: str, codes: tuple[int, ...] = (0, 1, 2, 3)) -> Run:
    """Run a command on a hostile input; fail unless it ends as it is promised."""
    before = tree(folder)
    ended = run(folder, *arguments)
    assert ended.code in codes, ended.text
    assert ended.seconds <= SOON, ended
    assert ended.mebibytes <= MAX_MEBIBYTES, ended
    assert tree(folder) == before
    assert len(ended.text) < 100_000
    for line in ended.text.split("\n"):
        assert line.isprintable(), line
        assert "##[" not in line
        assert not line.strip().startswith("::") or "github" in arguments, line
    return ended
