"""Commands of the user: split as a shell does, run without one, and ended with their time."""

import sys
import time

import pytest

from nrs_design.errors import NrsDesignError
from nrs_design.exporters.run_command import run_command, words_of


def test_words_are_those_of_a_shell_and_nothing_is_expanded():
    assert words_of("cc -D'A=b c' \"$X\" `y` ; z", "--compile") == (
        *("cc", "-DA=b c", "$X", "`y`", ";", "z"),
    )
    for line in ("cc 'x", ""):
        with pytest.raises(NrsDesignError, match="--compile") as caught:
            words_of(line, "--compile")
        assert caught.value.remedy


def test_what_it_says_on_both_streams_and_its_end(tmp_path):
    code = "import os, sys; print(os.getcwd()); sys.stderr.write(sys.stdin.read()); sys.exit(3)"
    done = run_command((sys.executable, "-c", code), tmp_path, "--run")
    assert (done.code, done.said) == (3, f"{tmp_path}\n")
    long = run_command((sys.executable, "-c", "print('x' * 10**6, 'end')"), tmp_path, "--run")
    assert len(long.said) == 2**16
    assert long.said.endswith("x end\n")


def test_a_program_beside_the_user_is_found(tmp_path, monkeypatch):
    """Though it runs in another folder."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "tool").write_text("#!/bin/sh\necho $0\n")
    (tmp_path / "tool").chmod(0o755)
    (tmp_path / "elsewhere").mkdir()
    assert run_command(("./tool",), tmp_path / "elsewhere", "--run").code == 0


def test_what_is_not_there_or_does_not_end(tmp_path):
    with pytest.raises(NrsDesignError, match="there is no program 'nothing-like-it' here"):
        run_command(("nothing-like-it",), tmp_path, "--compile")
    # What it has started ends with it, and nobody waits for that.
    start = "import subprocess, time; subprocess.Popen(['sleep', '60']); time.sleep(60)"
    before = time.monotonic()
    with pytest.raises(NrsDesignError, match=r"has not ended after 0\.5 s"):
        run_command((sys.executable, "-c", start), tmp_path, "--run", seconds=0.5)
    assert time.monotonic() - before < 30
