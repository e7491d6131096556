"""What is worst, and what lets the gate pass."""

import os
from pathlib import Path
from urllib.parse import unquote

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.errors import InternalError, SpecError
from nrs_design.gating.obligations import (
    GateOutcome,
    Obligation,
    SpecOutcome,
    Status,
    failed,
    is_utf8,
    relative_path,
    relative_uri,
)
from nrs_design.gating.rules import INTERNAL, MODE_STABLE, SPEC

PATH = Path("a.nrs.yaml")


def obligation(status, rule=SPEC):
    return Obligation(rule, PATH, "s", status, "m")


def test_proved_and_met_pass_and_nothing_else_does():
    passing = {status for status in Status if obligation(status).fulfilled}
    assert passing == {Status.PROVED, Status.MET}
    assert {status for status in Status if obligation(status).severity == 0} == passing


def test_the_worst_comes_first_and_decides():
    found = [obligation(status) for status in Status]
    outcome = GateOutcome((SpecOutcome(PATH, tuple(found)),))
    assert [item.status for item in outcome.broken] == [
        Status.ERROR,
        Status.MISSED,
        Status.REFUTED,
        Status.INCONCLUSIVE,
    ]
    assert outcome.severity == 3
    assert GateOutcome(()).severity == 0


def test_modes_of_one_controller_that_fail_alike_are_one_finding():
    def of_mode(name, line, status=Status.REFUTED):
        return Obligation(MODE_STABLE, PATH, name, status, f"{name} fails", line, 3)

    others = [obligation(Status.MISSED), obligation(Status.MISSED, INTERNAL)]
    modes = [of_mode("a/1", 5), of_mode("b/1", 9), of_mode("a/2", 5), of_mode("a/3", 5)]
    modes += [of_mode("a/4", 5, Status.PROVED), of_mode("a/5", 5, Status.INCONCLUSIVE)]
    outcome = GateOutcome((SpecOutcome(PATH, (*modes, *others)),))
    assert [item.message for item in outcome.findings] == [
        "m",
        "a/1 fails; likewise 2 more modes of its controller (--json)",
        "b/1 fails",
        "m",
        "a/5 fails",
    ]
    assert len(outcome.broken) == 7


def test_a_defect_of_the_program_is_worse_than_anything():
    assert obligation(Status.ERROR, INTERNAL).severity > obligation(Status.ERROR).severity
    (defect,) = failed(PATH, ZeroDivisionError("in\n  two lines")).obligations
    assert (defect.rule, defect.message) == (INTERNAL, "ZeroDivisionError: in two lines")
    assert failed(PATH, InternalError("they disagree")).obligations[0].severity >= 3


@pytest.mark.parametrize(
    ("path", "line", "words"),
    [(PATH, 7, "wrong (do it right)"), (Path("b"), None, "b:7:3: wrong (do it right)")],
)
def test_an_error_in_another_file_has_no_line_in_this_one(path, line, words):
    error = SpecError("wrong", path=path, line=7, column=3, remedy="do it right")
    (found,) = failed(PATH, error).obligations
    assert (found.line, found.message, found.status) == (line, words, Status.ERROR)


NAMES = st.text(st.characters(exclude_characters="/\0", codec="utf-8"), min_size=1).filter(
    lambda name: name not in (".", "..")
)


@given(NAMES)
def test_uri_reads_back_as_the_name(name):
    uri = relative_uri(Path("specs", name))
    assert unquote(uri) == f"specs/{name}"
    assert set(uri).isdisjoint(' "<>?#\n')
    assert uri.isascii()


@pytest.mark.parametrize("raw", [b"a\xff.nrs.yaml"])
def test_a_name_that_is_not_utf8_can_be_told_and_shown(raw):
    path = Path(os.fsdecode(raw))
    assert not is_utf8(path)
    assert is_utf8(Path("ä.nrs.yaml"))
    assert relative_path(path).encode() == b"a\\xff.nrs.yaml"
    assert relative_uri(path) == "a%FF.nrs.yaml"
