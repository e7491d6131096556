"""Every session that a page shows runs, and prints what is shown; every option shown exists."""

import os
import re
import shlex
import shutil
import sys
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from typer.main import get_command

from nrs_design.cli.app import make_app
from tests.docs.pages import commands_of, pages, python_of, session_of
from tests.support import ROOT, started
from tests.test_readme import assert_same

# The README has a test of its own, in process.
SESSIONS = [page for page in pages() if session_of(page) and page != "README.md"]
# Searches for gains, of which one takes as long as ten other pages.
NIGHTLY = ("docs/design/gains-with-proof.md", "docs/design/axes.md")
WRITTEN = {
    "docs/tutorial.md": {"arm.cert.json", "arm.html", "nrs.lock", "arm.c", "arm.h"},
    "docs/ci/README.md": {"mine.cert.json", "nrs.lock"},
}
# An installed package is all that these need.
ANYWHERE = {"docs/tutorial.md", "docs/index.md"}


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """A folder as pages take it for granted: specs, examples, and the records as ``data``."""
    folder = tmp_path / "checkout"
    shutil.copytree(ROOT / "specs", folder / "specs")
    shutil.copytree(ROOT / "docs" / "examples", folder / "docs" / "examples")
    shutil.copytree(ROOT / "specs" / "data", folder / "data")
    return folder


def environment(folder: Path) -> dict[str, str]:
    program = folder / "bin" / "nrs-design"
    program.parent.mkdir()
    program.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m nrs_design "$@"\n')
    program.chmod(0o755)
    return {
        "PATH": f"{program.parent}:{os.environ['PATH']}",
        "COLUMNS": "100",
        "PYTHONWARNINGS": "default",
    }


@pytest.mark.slow
@pytest.mark.parametrize(
    "page", [pytest.param(p, marks=[pytest.mark.nightly] * (p in NIGHTLY)) for p in SESSIONS]
)
def test_a_session_prints_what_is_shown(page: str, checkout: Path, tmp_path: Path) -> None:
    settings = environment(tmp_path)
    folder = tmp_path / "empty" if page in ANYWHERE else checkout
    folder.mkdir(exist_ok=True)
    for command, shown in session_of(page):
        result = started("bash", "-c", command, cwd=folder, python=False, **settings)
        assert_same(result.stdout, shown)
        assert not re.search("^error", result.stderr, re.MULTILINE), (command, result.stderr)
    written = {path.name for path in folder.rglob("*")}
    assert WRITTEN.get(page, set()) <= written


def test_pages_have_sessions() -> None:
    assert len(session_of("docs/tutorial.md")) >= 10
    assert not [command for command, _ in session_of("docs/tutorial.md") if " | " in command]
    how_to = {page for page in pages() if page.startswith("docs/how-to/")}
    assert how_to <= {*SESSIONS}


@cache
def program() -> Any:
    return get_command(make_app())


def unknown_options(line: str) -> list[str]:
    words = shlex.split(re.split(r" [|>] |  +#", line)[0])
    command = program()
    while words and hasattr(command, "commands") and not words[0].startswith("-"):
        if words[0] not in command.commands:
            return [words[0]]
        command = command.commands[words.pop(0)]
    known = {option for one in command.params for option in (*one.opts, *one.secondary_opts)} | {
        "--help"
    }
    return [word for word in words if re.match("--?[a-z]", word) and word not in known]


@pytest.mark.parametrize("page", [page for page in pages() if commands_of(page)])
def test_commands_and_options_exist(page: str) -> None:
    assert {line: unknown_options(line) for line in commands_of(page)} == {
        line: [] for line in commands_of(page)
    }


def test_an_option_that_does_not_exist_is_seen() -> None:
    assert unknown_options("gate specs --locked --lokced") == ["--lokced"]
    assert unknown_options("identify tisue a.csv") == ["tisue"]
    assert unknown_options("certify-switching a.nrs.yaml --no-optimize-rate | head -1") == []


@pytest.mark.slow
@pytest.mark.parametrize("page", [page for page in pages() if python_of(page)])
def test_python_on_a_page_runs(page: str, checkout: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(checkout)
    namespace: dict[str, object] = {"__name__": "page"}
    for block in python_of(page):
        exec(compile(block, page, "exec"), namespace)
