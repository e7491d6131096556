"""Runs a command as a user does, and measures what it takes and what it touches."""

import hashlib
import json
import os
import select
import signal
import subprocess
import sys
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from tests.support import ROOT, SOON

MAX_MEBIBYTES = 300.0
# Far beyond what is allowed: only so that a hang ends.
PATIENCE = 120


@dataclass(frozen=True)
class Run:
    code: int
    text: str
    seconds: float
    mebibytes: float


@cache
def server() -> subprocess.Popen[str]:
    """Start the process that copies itself; it ends with this one, which holds its stdin."""
    return subprocess.Popen(
        [sys.executable, "-m", "tests.hostile.server"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        cwd=ROOT,
        start_new_session=True,
    )


def run(folder: Path, *arguments: str) -> Run:
    """Run a command in ``folder/work``; its needs are noted down in ``folder/scratch``."""
    scratch = folder / "scratch"
    scratch.mkdir(exist_ok=True)
    places = {name: str(scratch / name) for name in ("needs", "out", "err")}
    environment = {"HOME": folder / "home", "TMPDIR": scratch, "MPLCONFIGDIR": scratch}
    order = {
        "folder": str(folder / "work"),
        "environment": {name: str(path) for name, path in environment.items()},
        "arguments": arguments,
        **places,
    }
    process = server()
    print(json.dumps(order), file=process.stdin, flush=True)
    if not select.select([process.stdout], [], [], PATIENCE)[0]:
        os.killpg(process.pid, signal.SIGKILL)
        server.cache_clear()
        raise TimeoutError(f"no end within {PATIENCE} s")
    code = int(process.stdout.readline())
    measured = json.loads(Path(places["needs"]).read_text())
    written = (Path(places[name]).read_bytes() for name in ("out", "err"))
    text = b"".join(written).decode("utf-8", "surrogateescape")
    return Run(code, text, measured["seconds"], measured["mebibytes"])


def tree(folder: Path) -> dict[str, str]:
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
