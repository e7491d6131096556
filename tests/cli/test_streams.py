"""A reader that goes away changes nothing."""

import sys

import pytest

from tests.support import COMMUTING, PRINT_ERROR, SOFT_TISSUE, started, typed
from tests.terminal import run_on_terminal

COMMUTING, PRINT_ERROR, SOFT_TISSUE = map(str, (COMMUTING, PRINT_ERROR, SOFT_TISSUE))


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        pytest.param(("check", SOFT_TISSUE), 0, marks=pytest.mark.slow),
        (("certify-switching", PRINT_ERROR, "-v"), 1),
        (("check", "missing.nrs.yaml"), 2),
    ],
)
def test_head_does_not_change_the_exit_code(tmp_path, arguments, code):
    program = f'"{sys.executable}" -m nrs_design "$@" 2>&1'
    command = program + " | head -n 1 >/dev/null; echo ${PIPESTATUS[0]}"
    done = started("bash", "-c", command, "bash", *arguments, cwd=tmp_path, python=False)
    assert (done.stdout, done.stderr) == (f"{code}\n", "")


@pytest.mark.parametrize(
    ("spec", "code", "word"),
    [
        (COMMUTING, 0, "\x1b[1;32mPROVED"),
        pytest.param(PRINT_ERROR, 1, "\x1b[1;31mREFUTED", marks=pytest.mark.slow),
    ],
)
def test_verdicts_in_colour(tmp_path, spec, code, word):
    shown, ended = run_on_terminal(80, "certify-switching", spec, cwd=tmp_path)
    assert word in shown
    assert ended == code
    assert "\x1b" not in typed("certify-switching", spec, cwd=tmp_path).stdout
