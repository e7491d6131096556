"""The program itself: help, version, and how errors end."""

import subprocess
import sys

import pytest

from nrs_design import __version__
from nrs_design.cli.app import make_app
from tests.support import COMMUTING, ROOT, run

COMMANDS = [command.name for command in make_app().registered_commands]


def test_version(tmp_path):
    assert run("--version", cwd=tmp_path).stdout == f"nrs-design {__version__}\n"


def test_help_lists_every_command_and_exit_code(tmp_path):
    text = run("--help", cwd=tmp_path).stdout
    for command in COMMANDS:
        assert command in text
    assert {"optimize", "tune", "certify-switching", "verify"} <= set(COMMANDS)
    assert "0 proved or goal met" in " ".join(text.split())


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_has_an_example(tmp_path, command):
    result = run(command, "--help", cwd=tmp_path)
    assert result.returncode == 0
    assert f"nrs-design {command}" in " ".join(result.stdout.split()), result.stdout


@pytest.mark.parametrize("arguments", [["nonsense"], ["--nonsense"], ["verify"]])
def test_wrong_usage(tmp_path, arguments):
    assert run(*arguments, cwd=tmp_path).returncode == 2


def crash(tmp_path, *options):
    program = (
        "import sys, nrs_design.spec as s\n"
        "def fail(path): raise ZeroDivisionError('boom')\n"
        "s.read_spec = fail\n"
        "from nrs_design.cli import main; main()"
    )
    return subprocess.run(
        [sys.executable, "-c", program, "certify-switching", str(COMMUTING), *options],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        check=False,
    )


def test_a_defect_is_exit_code_4(tmp_path):
    result = crash(tmp_path)
    assert result.returncode == 4
    assert "internal error: ZeroDivisionError: boom" in result.stderr
    assert "Traceback" not in result.stderr
    assert result.stdout == ""
    assert "Traceback" in crash(tmp_path, "-v").stderr


def test_as_a_module_and_as_a_program():
    result = subprocess.run(
        [sys.executable, "-m", "nrs_design", "--version"],
        capture_output=True,
        text=True,
        cwd=ROOT,
        check=False,
    )
    assert result.stdout.startswith("nrs-design ")
