"""Where text leaves the program: colours, line breaks, and what is made harmless."""

import io
import json
import re

import pytest

from nrs_design.cli.printing import (
    insist,
    note,
    output,
    painted,
    print_json,
    progress,
    say,
    say_failure,
    wrapped,
)
from tests.tables import rows


class Terminal(io.StringIO):
    def isatty(self):
        return True


@pytest.fixture
def narrow(monkeypatch):
    monkeypatch.setenv("COLUMNS", "20")


def test_json_comes_in_an_envelope(capsys):
    print_json("verify", {"words": "a\x1b[31m"})
    said = capsys.readouterr().out
    assert json.loads(said) == {"schema": "nrs-design/verify/1", "words": "a\x1b[31m"}
    assert "\x1b" not in said


def test_json_has_no_number_that_is_none(capsys):
    with pytest.raises(ValueError, match="not JSON compliant"):
        print_json("verify", {"rate": float("nan")})
    assert capsys.readouterr().out == ""


@pytest.mark.parametrize(
    ("variables", "coloured"), [({}, True), ({"NO_COLOR": "1"}, False), ({"TERM": "dumb"}, False)]
)
def test_colours_are_for_those_who_want_them(monkeypatch, variables, coloured):
    for name in ("NO_COLOR", "TERM"):
        monkeypatch.delenv(name, raising=False)
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    expected = "\x1b[1;32mPROVED\x1b[0m" if coloured else "PROVED"
    assert painted("PROVED", "green", Terminal()) == expected
    assert painted("PROVED", "green", io.StringIO()) == "PROVED"


def test_lines_break_between_words(narrow):
    line = "  one two three four five six"
    assert wrapped(line, Terminal()) == "  one two three four\n    five six"
    assert wrapped(line, Terminal(), hanging=0) == "  one two three four\n  five six"


def test_a_pipe_gets_a_hundred_columns_unless_told_otherwise(monkeypatch):
    line = "word " * 40
    monkeypatch.delenv("COLUMNS")
    lines = wrapped(line, io.StringIO()).split("\n")
    assert 90 < max(map(len, lines)) <= 100
    monkeypatch.setenv("COLUMNS", "50")
    assert max(map(len, wrapped(line, io.StringIO()).split("\n"))) <= 50


def test_a_long_name_is_not_cut(narrow):
    name = "a" * 30
    assert wrapped(f"see {name}", Terminal()) == f"see\n  {name}"


@pytest.mark.parametrize("print_line", [say, lambda line: say_failure(line, "missed")])
def test_what_strangers_wrote_steers_no_terminal(capsys, print_line):
    print_line("missed: name\x1b[2J\u202e")
    assert capsys.readouterr().out == "missed: name\\x1b[2J\\u202e\n"


@pytest.mark.parametrize(
    ("as_json", "quiet", "out", "err"), rows(__file__, "test_what_json_and_quiet_silence")
)
def test_what_json_and_quiet_silence(capsys, as_json, quiet, out, err):
    with output(as_json=as_json, quiet=quiet):
        say("text")
        say_failure("missed: all", "missed")
        note("note")
        insist("anyway")
    assert capsys.readouterr() == (out, err)


def test_no_spinner_without_a_terminal(capsys):
    with progress("certifying") as step:
        step("lmi")
    assert capsys.readouterr() == ("", "")


def test_a_long_step_is_told_without_a_terminal(monkeypatch, capsys):
    monkeypatch.setattr("nrs_design.cli.printing.SILENCE", 0.0)
    with progress("certifying") as step:
        step("lmi\x1b[2J")
    assert re.fullmatch(r"certifying: lmi\\x1b\[2J \(\d+ s\)\n", capsys.readouterr().err)
    with output(as_json=False, quiet=True), progress("certifying") as step:
        step("lmi")
    assert capsys.readouterr().err == ""
